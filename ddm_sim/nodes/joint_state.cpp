// State and torques of a plant as a sensor_msgs/JointState.
// SPDX-License-Identifier: BSD-3-Clause
#include "joint_state.h"

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>
#include <string>
#include <vector>

namespace ddm {
namespace {

std::vector<double> toVector(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

}  // namespace

sensor_msgs::JointState jointStateOf(const Plant& plant, const Eigen::VectorXd& applied) {
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
