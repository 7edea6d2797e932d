// Parameters of the deep dynamical model and of its training. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Block `image`.
struct ImageOptions {
  int size = 51;  ///< images have size x size pixels, D = size^2

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("size", size);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// Block `model`: the architecture. Defaults are the paper's.
struct ModelOptions {
  int pca_dim = 50;                               ///< input of the encoder [-]
  int feature_dim = 2;                            ///< dim z [-]
  int order = 2;                                  ///< n, features and torques that f sees [-]
  std::vector<int> encoder_widths = {25, 12, 6};  ///< hidden layers of g^-1
  std::vector<int> decoder_widths = {6, 12, 25};  ///< hidden layers of g
  std::vector<int> predictor_widths = {4};        ///< hidden layers of f
  double max_torque = 6.0;                        ///< f sees u / max_torque [N m]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("pca_dim", pca_dim);
    visitor("feature_dim", feature_dim);
    visitor("order", order);
    visitor("encoder_widths", encoder_widths);
    visitor("decoder_widths", decoder_widths);
    visitor("predictor_widths", predictor_widths);
    visitor("max_torque", max_torque);
  }
  std::vector<std::string> problems() const;
};

/// Block `training`.
struct TrainingOptions {
  std::string schedule = "joint";    ///< what is minimised over what, see scheduleNames()
  std::string solver = "lbfgs";      ///< "lbfgs" or "bfgs"
  int num_starts = 1;                ///< trainings, of which the best is kept [-]
  int max_iterations = 500;          ///< cap on the iterations of the solver, each stage [-]
  double function_tolerance = 1e-6;  ///< stop when V changes by less than this fraction [-]
  int lbfgs_rank = 20;               ///< pairs that L-BFGS remembers [-]
  double score_std = 1.0;            ///< spread of the leading PCA score at the encoder's input [-]
  double layer_std = 0.3;            ///< spread of a layer's leading unit after initialisation [-]
  double predictor_gain = 1.0;       ///< f starts at weights N(0, gain^2 / fan-in) [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("schedule", schedule);
    visitor("solver", solver);
    visitor("num_starts", num_starts);
    visitor("max_iterations", max_iterations);
    visitor("function_tolerance", function_tolerance);
    visitor("lbfgs_rank", lbfgs_rank);
    visitor("score_std", score_std);
    visitor("layer_std", layer_std);
    visitor("predictor_gain", predictor_gain);
  }
  std::vector<std::string> problems() const;
};

}  // namespace ddm
