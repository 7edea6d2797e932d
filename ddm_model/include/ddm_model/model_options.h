// Parameters of the deep dynamical model and of its training. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Block `model`: the architecture. The defaults are those of the paper (Sec. 4).
struct ModelOptions {
  bool normalise_brightness = false;  ///< whether all images get the same root mean square
  double blur = 0.0;                  ///< std of the Gaussian blur of all images [pixels]
  int pca_dim = 50;                   ///< principal components; input of the encoder [-]
  int feature_dim = 2;                ///< dim z [-]
  /// n, past torques in the input of f; so many features, too, or with predictor gp at most two [-]
  int order = 2;
  std::vector<int> encoder_widths = {25, 12, 6};  ///< hidden layers of g^-1; g mirrors them
  /// "network"; "gp": f sees the last change of the feature and predicts the next one, and
  /// after the training a Gaussian process replaces the network in f.
  std::string predictor = "network";
  std::vector<int> predictor_widths = {4};  ///< hidden layers of the network in f
  /// Scale of the torques: f sees u / max_torque [N m]. One number for all motors, or one each.
  std::vector<double> max_torque = {6.0};

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("normalise_brightness", normalise_brightness);
    visitor("blur", blur);
    visitor("pca_dim", pca_dim);
    visitor("feature_dim", feature_dim);
    visitor("order", order);
    visitor("encoder_widths", encoder_widths);
    visitor("predictor", predictor);
    visitor("predictor_widths", predictor_widths);
    visitor("max_torque", max_torque);
  }
  /// @return whether f sees the last change of the feature and predicts the next one
  bool featureDifferences() const { return predictor == "gp"; }
  /// @return hidden layers of g, feature first
  std::vector<int> decoderWidths() const {
    return std::vector<int>(encoder_widths.rbegin(), encoder_widths.rend());
  }
  std::vector<std::string> problems() const;
};

/// Block `training`.
struct TrainingOptions {
  std::string schedule = "joint";    ///< terms and free parameters, see scheduleNames()
  std::string solver = "lbfgs";      ///< "lbfgs", "kfac" or "bfgs"
  int num_starts = 1;                ///< restarts; training keeps the best [-]
  int max_iterations = 500;          ///< cap on the solver's iterations in each stage [-]
  int prediction_steps = 1;          ///< k: V_P counts predictions 1 ... k steps ahead [-]
  double weight_decay = 0.0;         ///< weight of V_W, the sum of squared weights [score^2]
  double function_tolerance = 1e-6;  ///< stop if V changes by less than this fraction [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("schedule", schedule);
    visitor("solver", solver);
    visitor("num_starts", num_starts);
    visitor("max_iterations", max_iterations);
    visitor("prediction_steps", prediction_steps);
    visitor("weight_decay", weight_decay);
    visitor("function_tolerance", function_tolerance);
  }
  std::vector<std::string> problems() const;
};

}  // namespace ddm
