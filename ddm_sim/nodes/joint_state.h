// Converts state and torque of a plant to a sensor_msgs/JointState.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/JointState.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <string>
#include <vector>

#include "ddm_sim/plant.h"

namespace ddm {

/// Makes a message with the complete state and the torque. Each array is empty or has the length of
/// `name`:
///
///   velocity  the components of the state after the joint positions, if there is one for each
///             joint and all their names end in "_per_s"; otherwise empty
///   position  the positions of the joints; without velocities also all further components of the
///             state, with their names in info().state_names as `name`
///   effort    the torque, if the number of motors equals the number of names; otherwise empty
///
/// The concatenation of position and velocity is always the state of the plant.
/// @param applied  torque of the step that led to the state                       [torqueDim() x 1]
/// @return         message without a stamp
inline sensor_msgs::JointState jointStateOf(const Plant& plant, const Eigen::VectorXd& applied) {
  const auto toVector = [](const auto& values) {
    return std::vector<double>(values.data(), values.data() + values.size());
  };
  sensor_msgs::JointState out;
  for (const Joint& joint : plant.info().joints) out.name.push_back(joint.name);
  const std::vector<std::string>& components = plant.info().state_names;
  const auto rest = components.begin() + static_cast<std::ptrdiff_t>(out.name.size());
  const bool has_rates = components.size() == 2 * out.name.size() &&
                         std::all_of(rest, components.end(), [](const std::string& name) {
                           return boost::algorithm::ends_with(name, "_per_s");
                         });
  if (!has_rates) out.name.insert(out.name.end(), rest, components.end());
  const auto num_names = static_cast<Eigen::Index>(out.name.size());
  out.position = toVector(plant.state().head(num_names));
  out.velocity = toVector(plant.state().tail(plant.stateDim() - num_names));
  if (applied.size() == num_names) out.effort = toVector(applied);
  return out;
}

}  // namespace ddm
