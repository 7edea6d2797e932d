// The motors of a model: which joints, how strong.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_mujoco/plant_proposal.h"

namespace ddm {

struct Motor {
  int joint = 0;  ///< that it turns or shifts
  std::optional<double>
      limit;  ///< of its torque by the file [N m or N]; none: the file does not say
};

/// Those of `motors`, or the actuators of the file in its order.
/// @throws std::invalid_argument naming what is not a motor of a hinge or slide, or what is missing
std::vector<Motor> motorsOf(const MujocoModel& model, const MujocoOptions& options);

/// The bound of each motor: `max_torque`, or the limits of the file.
/// @throws std::invalid_argument naming a joint that has none, or whose motor is weaker
std::vector<double> limitsOf(const MujocoModel& model, const MujocoOptions& options);

struct MotorChoice {
  std::vector<std::string> joints;
  std::string why;
  bool by_actuators = false;  ///< the file's own motors: `plant/motors` stays empty
};

/// Which one or two joints have a motor: those of the file's actuators, of its transmissions, those
/// with an effort limit, or the only joint.
/// @throws std::invalid_argument with the joints that could have one if the file does not say
MotorChoice chosenMotors(const MujocoModel& model, const std::vector<ModelJoint>& joints);

}  // namespace ddm
