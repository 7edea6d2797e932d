// State and torques of a plant as a sensor_msgs/JointState.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/JointState.h>

#include <Eigen/Core>

#include "ddm_sim/plant.h"

namespace ddm {

/// The whole state and the torque, in arrays that are empty or as long as `name`:
///
///   as many further components as joints, each named "..._per_s":  they are `velocity`
///   else:  each further component is a `position` after those of the joints, and named as in the
///          plant's stateNames()
///   `effort` is the torque where there are as many motors as names, else it is empty
///
/// So position, then velocity, are always the plant's state.
/// @param applied  torque of the step that led to the state                   [torqueDim() x 1]
/// @return         without a stamp
sensor_msgs::JointState jointStateOf(const Plant& plant, const Eigen::VectorXd& applied);

}  // namespace ddm
