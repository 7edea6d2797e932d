// Where policy search starts: the RBF policy of PILCO's first trial.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_pilco/squashed_policy.h>
#include <ddm_pilco/trigonometric.h>

#include <Eigen/Core>
#include <memory>
#include <random>

#include "observation.h"

namespace ddm {

/// An RBF policy that is squashed, its parameters not yet set.
/// @param max_torque  bound of each torque [N m]
std::shared_ptr<pilco::SquashedPolicy> makePilcoPolicy(int feature_dim, int num_centres,
                                                       const Eigen::VectorXd& max_torque);

/// Parameters of such a policy: centres drawn from the features of the start distribution, which is
/// taken as Gaussian, small random targets, length-scales of the task.
/// @param features  of the task's state
Eigen::VectorXd drawPolicyStart(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng);

}  // namespace ddm
