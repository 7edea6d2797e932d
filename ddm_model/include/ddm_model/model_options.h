// Parameters of the deep dynamical model and of its training. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace ddm {

/// Block `model`: the architecture. Defaults are the paper's.
struct ModelOptions {
  double blur = 0.0;                              ///< images are seen through, std [pixels]
  int pca_dim = 50;                               ///< input of the encoder [-]
  int feature_dim = 2;                            ///< dim z [-]
  int order = 2;                                  ///< n, features and torques that f sees [-]
  int delay = 0;                                  ///< d, how late an image shows a torque [frames]
  std::vector<int> encoder_widths = {25, 12, 6};  ///< hidden layers of g^-1; those of g mirror them
  std::vector<int> predictor_widths = {4};        ///< hidden layers of f
  bool residual = false;                          ///< f predicts the change of z, not z
  bool increments = false;                        ///< f sees past features as their differences
  std::vector<double> max_torque = {6.0};  ///< f sees u / max_torque; one, or one per motor [N m]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("blur", blur);
    visitor("pca_dim", pca_dim);
    visitor("feature_dim", feature_dim);
    visitor("order", order);
    visitor("delay", delay);
    visitor("encoder_widths", encoder_widths);
    visitor("predictor_widths", predictor_widths);
    visitor("residual", residual);
    visitor("increments", increments);
    visitor("max_torque", max_torque);
  }
  /// Frames that f looks back: n + d.
  int memory() const { return order + delay; }
  /// Hidden layers of g, feature first.
  std::vector<int> decoderWidths() const {
    return std::vector<int>(encoder_widths.rbegin(), encoder_widths.rend());
  }
  std::vector<std::string> problems() const;
};

/// Block `training`.
struct TrainingOptions {
  std::string schedule = "joint";  ///< what is minimised over what, see scheduleNames()
  std::string solver = "lbfgs";    ///< "lbfgs", "kfac" or "bfgs"
  int num_starts = 1;              ///< restarts, of which the best is kept [-]
  int max_delay = 0;               ///< largest model/delay that is tried [frames]
  int selection_steps = 0;         ///< by predictions so many steps ahead; 0: by what is minimised
  int selection_iterations = 0;  ///< of each restart's last stage before they are compared; 0: all
  int selection_frames = 0;      ///< compared on so many frames at most; 0: on all
  int max_iterations = 500;      ///< cap on the iterations of the solver, each stage [-]
  int prediction_steps = 1;      ///< V_P: predictions up to so many steps ahead [-]
  int warm_up_iterations = 100;  ///< cap on those with one step first, if more are asked for [-]
  double weight_decay = 0.0;     ///< weight of V_W, the squared weights [score^2]
  double function_tolerance = 1e-6;  ///< stop when V changes by less than this fraction [-]
  int lbfgs_rank = 20;               ///< pairs that L-BFGS remembers [-]

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

/// The largest delay that is tried.
inline int largestDelay(const ModelOptions& model, const TrainingOptions& training) {
  return std::max(model.delay, training.max_delay);
}

}  // namespace ddm
