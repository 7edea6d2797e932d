// State and torques of a plant as a sensor_msgs/JointState.
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

/// The whole state and the torque, in arrays that are empty or as long as `name`:
///
///   as many further components as joints, each named "..._per_s":  they are `velocity`
///   else:  each further component is a `position` after those of the joints, and named as in the
///          plant's info().state_names
///   `effort` is the torque where there are as many motors as names, else it is empty
///
/// So position, then velocity, are always the plant's state.
/// @param applied  torque of the step that led to the state                   [torqueDim() x 1]
/// @return         without a stamp
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
