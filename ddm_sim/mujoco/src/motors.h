// Motors of a model: their joints and their limits.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_mujoco/plant_proposal.h"

namespace ddm {

struct Motor {
  int joint = 0;  ///< index of the joint that the motor moves
  /// Limit of the motor's torque or force in the file [N m or N]; 0: unknown. Many files from CAD
  /// exporters have 0 for an unknown limit.
  double limit = 0.0;
  std::string why_unknown = "has no limit";  ///< what the file says if `limit` is 0
};

/// Motors of the option `motors`, or the actuators of the file in their order.
/// @throws std::invalid_argument naming a motor that does not move a hinge or slide, or the missing
///         motors
std::vector<Motor> motorsOf(const MujocoModel& model, const MujocoOptions& options);

/// Bound of each motor [N m or N]: the option `max_torque`, or the limits of the file.
/// @throws std::invalid_argument naming a joint that has no limit, or a motor whose limit in the
///         file is below `max_torque`
std::vector<double> limitsOf(const MujocoModel& model, const MujocoOptions& options);

struct MotorChoice {
  std::vector<std::string> joints;
  std::string why;
  /// True: the actuators of the file, so that `plant/motors` stays empty.
  bool by_actuators = false;
};

/// Chooses one or two joints that have a motor: the joints of the file's actuators, else those of
/// its transmissions, else those with an effort limit, else the only joint.
/// @throws std::invalid_argument with the joints that could have a motor if the file does not say
///         which one has
MotorChoice chosenMotors(const MujocoModel& model, const std::vector<ModelJoint>& joints);

}  // namespace ddm
