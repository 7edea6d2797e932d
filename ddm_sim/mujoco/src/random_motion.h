// Simulates a model under random torques.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>

#include "ddm_mujoco/mujoco_options.h"
#include "mechanism.h"

namespace ddm {

/// State of a mechanism at rest: positions and zero rates.
/// @param position  of all joints  [n x 1]
/// @return [2 n x 1]
Eigen::VectorXd atRest(const Eigen::VectorXd& position);

/// Simulates several runs from the start and from the goal of the options.
/// @param share  share of options.max_torque that the random torques reach
/// @return speed that the fastest joint exceeds in 5 % of the physics steps, in units of the joints
///         per second, see Mechanism::unit()
/// @throws std::range_error if the simulation is unstable
double speedUnderRandomTorques(const std::shared_ptr<const MujocoModel>& model,
                               const Mechanism& mechanism, const MujocoOptions& options,
                               std::size_t num_motors, double share);

}  // namespace ddm
