// One stage of a training schedule, minimised by BFGS, or by L-BFGS, preconditioned or not.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

#include "ddm_model/minimise.h"
#include "ddm_model/objective.h"
#include "ddm_model/schedule.h"

namespace ddm {

/// Called after each iteration with the best point so far and V_R, V_P there; false ends the stage.
using StageCallback =
    std::function<bool(const Minimum& so_far, const JointObjective<float>::Value& value)>;

/// Minimises w times the terms of the stage over the parameters that it leaves free.
/// @param theta     in: all parameters, out: with the free ones at the minimum; as they were if the
///                  objective cannot be evaluated there                            [P]
/// @param callback  may be empty
Minimum minimiseStage(const Stage& stage, const TrainingOptions& training,
                      const Networks<float>& networks, JointObjective<float>* objective,
                      Eigen::VectorXd* theta, const StageCallback& callback);

}  // namespace ddm
