// Training schedule: the stages of a training, each with its terms and free parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_model/model_options.h"

namespace ddm {

/// Terms of the objective.
struct Terms {
  bool v_r = true;            ///< V_R, reconstruction error
  bool v_p = true;            ///< V_P, prediction error
  int prediction_steps = 1;   ///< k, number of prediction steps in V_P [-]
  double weight_decay = 0.0;  ///< weight of V_W [score^2]
};

/// One minimisation: `terms` over the free parameters. The other parameters stay fixed.
struct Stage {
  enum class Free { kAll, kAutoEncoder, kPredictor };

  Terms terms;
  Free free = Free::kAll;
  int max_iterations = 0;  ///< cap on the iterations of the solver
};

/// Stages of a training.
struct Schedule {
  bool pca_start = true;      ///< layer-wise PCA initialises the auto-encoder; false: random
  std::vector<Stage> stages;  ///< at least one

  /// @return all terms that occur in a stage
  Terms terms() const;
};

/// @return the valid values of `training/schedule`:
///
///   joint              V_R + V_P over all parameters (paper, eq. 5a)
///   sequential         V_R over theta_E and theta_D, then V_P over theta_P with fixed features
///                      (the paper's counter-example, footnote in Sec. 2.3)
///   v_p_only           V_P over all parameters, without V_R, which the paper calls crucial
///   v_r_only           V_R over theta_E and theta_D; f keeps its random initial weights
///   joint_random_init  like joint, but the auto-encoder has random initial weights
std::vector<std::string> scheduleNames();

/// Builds the stages of training/schedule, with the prediction steps, weight decay and iterations
/// of `training`.
/// @pre training/schedule is one of scheduleNames(), as TrainingOptions::problems() checks
Schedule makeSchedule(const TrainingOptions& training);

}  // namespace ddm
