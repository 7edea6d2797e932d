// Parameters of the deep dynamical model and of its training. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace ddm {

/// Block `model`: the architecture. The defaults are those of the paper (Sec. 4).
struct ModelOptions {
  double blur = 0.0;    ///< std of the Gaussian blur of all images [pixels]
  int pca_dim = 50;     ///< principal components; input of the encoder [-]
  int feature_dim = 2;  ///< dim z [-]
  int order = 2;        ///< n, past features and torques in the input of f [-]
  int delay = 0;        ///< d, delay of the images [samples]
  std::vector<int> encoder_widths = {25, 12, 6};  ///< hidden layers of g^-1; g mirrors them
  /// "network"; "gp": after the training, a Gaussian process replaces the network in f.
  std::string predictor = "network";
  std::vector<int> predictor_widths = {4};  ///< hidden layers of the network in f
  bool residual = false;                    ///< f predicts the change of z instead of z
  bool increments = false;                  ///< past features enter f as differences
  /// Scale of the torques: f sees u / max_torque [N m]. One number for all motors, or one each.
  std::vector<double> max_torque = {6.0};

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("blur", blur);
    visitor("pca_dim", pca_dim);
    visitor("feature_dim", feature_dim);
    visitor("order", order);
    visitor("delay", delay);
    visitor("encoder_widths", encoder_widths);
    visitor("predictor", predictor);
    visitor("predictor_widths", predictor_widths);
    visitor("residual", residual);
    visitor("increments", increments);
    visitor("max_torque", max_torque);
  }
  /// @return n + d, the number of samples that f looks back
  int memory() const { return order + delay; }
  /// @return hidden layers of g, feature first
  std::vector<int> decoderWidths() const {
    return std::vector<int>(encoder_widths.rbegin(), encoder_widths.rend());
  }
  std::vector<std::string> problems() const;
};

/// Block `training`.
struct TrainingOptions {
  std::string schedule = "joint";  ///< terms and free parameters, see scheduleNames()
  std::string solver = "lbfgs";    ///< "lbfgs", "kfac" or "bfgs"
  int num_starts = 1;              ///< restarts; training keeps the best [-]
  int max_delay = 0;               ///< largest model/delay that training tries [samples]
  /// The best restart has the smallest error of predictions over so many steps [-]; 0: the smallest
  /// objective.
  int selection_steps = 0;
  int selection_iterations = 0;      ///< iterations of the last stage before the choice; 0: all [-]
  int selection_frames = 0;          ///< samples for the choice at most; 0: all [-]
  int max_iterations = 500;          ///< cap on the solver's iterations in each stage [-]
  int prediction_steps = 1;          ///< k: V_P counts predictions 1 ... k steps ahead [-]
  int warm_up_iterations = 100;      ///< if k > 1: cap on the iterations with k = 1 before [-]
  double weight_decay = 0.0;         ///< weight of V_W, the sum of squared weights [score^2]
  double function_tolerance = 1e-6;  ///< stop if V changes by less than this fraction [-]
  int lbfgs_rank = 20;               ///< steps that L-BFGS stores [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("schedule", schedule);
    visitor("solver", solver);
    visitor("num_starts", num_starts);
    visitor("max_delay", max_delay);
    visitor("selection_steps", selection_steps);
    visitor("selection_iterations", selection_iterations);
    visitor("selection_frames", selection_frames);
    visitor("max_iterations", max_iterations);
    visitor("prediction_steps", prediction_steps);
    visitor("warm_up_iterations", warm_up_iterations);
    visitor("weight_decay", weight_decay);
    visitor("function_tolerance", function_tolerance);
    visitor("lbfgs_rank", lbfgs_rank);
  }
  std::vector<std::string> problems() const;
};

/// @return the largest delay that training tries [samples]
inline int largestDelay(const ModelOptions& model, const TrainingOptions& training) {
  return std::max(model.delay, training.max_delay);
}

}  // namespace ddm
