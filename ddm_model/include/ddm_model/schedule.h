// Training schedule: what is minimised over which parameters, one stage after the other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ddm_model/model_options.h"

namespace ddm {

/// The terms of the objective that count.
struct Terms {
  bool v_r = true;            ///< V_R, reconstruction error
  bool v_p = true;            ///< V_P, prediction error
  int prediction_steps = 1;   ///< k of V_P
  double weight_decay = 0.0;  ///< weight of V_W
};

/// One minimisation: `terms` over the parameters that are free, the others held fixed.
struct Stage {
  enum class Free { kAll, kAutoEncoder, kPredictor };

  Terms terms;
  Free free = Free::kAll;
  int max_iterations = 0;  ///< cap on the iterations of the solver
};

/// How theta is found.
struct Schedule {
  bool pca_start = true;        ///< auto-encoder starts from layer-wise PCA; false: at random
  std::vector<Stage> stages;    ///< at least one; each restart goes through them
  std::optional<Stage> finish;  ///< for the best restart alone, on more and more frames

  /// The terms that any stage minimises.
  Terms terms() const;
};

/// The values that `training/schedule` may have.
///
///   joint              V_R + V_P over all parameters (paper, eq. 5a)
///   sequential         V_R over theta_E and theta_D, then V_P over theta_P: the features are fixed
///                      before f is learned (the paper's counter-example, footnote in Sec. 2.3)
///   v_p_only           V_P over all parameters: without the term that the paper calls crucial
///   v_r_only           V_R over theta_E and theta_D; f stays random: an auto-encoder alone
///   joint_random_init  as joint, without the PCA start
std::vector<std::string> scheduleNames();

/// The schedule training/schedule with what else `training` says of V_P, V_W and iterations. Where
/// predictions of more than one step are asked for, each stage with V_P is warmed up by one with a
/// single step: long predictions of an untrained f have no useful gradient. Where restarts are
/// compared before they are done, `finish` is the rest of the last stage.
/// @pre the schedule has one of scheduleNames(), as TrainingOptions::problems() checks
Schedule makeSchedule(const TrainingOptions& training);

}  // namespace ddm
