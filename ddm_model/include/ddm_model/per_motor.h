// Torque limits: one number for all motors, or one number for each motor.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

namespace ddm {

/// @return limits as a YAML file has them: "6", "[4, 2]"
inline std::string limitsText(const std::vector<double>& limits) {
  std::string text;
  for (const double limit : limits) text += textOf(text.empty() ? "" : ", ", limit);
  return limits.size() == 1 ? text : "[" + text + "]";
}

/// @return whether there is at least one limit and all limits are positive and finite
inline bool areLimits(const std::vector<double>& limits) {
  return !limits.empty() && std::all_of(limits.begin(), limits.end(), isPositive);
}

/// Expands limits to one number for each motor.
/// @param limits  one number for all motors, or one for each motor
/// @param key     name of the parameter in the error message, such as "model/max_torque"
/// @return        [torque_dim]
/// @throws std::invalid_argument for any other number of limits
inline Eigen::VectorXd perMotor(const std::vector<double>& limits, int torque_dim,
                                const std::string& key) {
  if (limits.size() == 1) return Eigen::VectorXd::Constant(torque_dim, limits[0]);
  if (static_cast<int>(limits.size()) == torque_dim) {
    return Eigen::Map<const Eigen::VectorXd>(limits.data(), torque_dim);
  }
  throw std::invalid_argument(textOf(key, " must be one number for all motors or one for each of ",
                                     torque_dim, ", got ", limitsText(limits)));
}

/// @return whether each motor's limit in `limits` is at most its limit in `outer`; false if both
///         have several numbers, but not equally many
inline bool within(const std::vector<double>& limits, const std::vector<double>& outer) {
  const size_t count = std::max(limits.size(), outer.size());
  const auto fits = [count](size_t size) { return size == 1 || size == count; };
  if (!fits(limits.size()) || !fits(outer.size())) return false;
  for (size_t i = 0; i < count; ++i) {
    if (!(limits[limits.size() == 1 ? 0 : i] <= outer[outer.size() == 1 ? 0 : i])) return false;
  }
  return true;
}

}  // namespace ddm
