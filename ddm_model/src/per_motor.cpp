// Torque limits: one number for all motors, or one number for each motor.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/per_motor.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <stdexcept>

namespace ddm {

Eigen::VectorXd perMotor(const std::vector<double>& limits, int torque_dim,
                         const std::string& key) {
  if (limits.size() == 1) return Eigen::VectorXd::Constant(torque_dim, limits[0]);
  if (static_cast<int>(limits.size()) != torque_dim) {
    throw std::invalid_argument(textOf(key,
                                       " must be one number for all motors or one for each of ",
                                       torque_dim, ", got ", limitsText(limits)));
  }
  return Eigen::Map<const Eigen::VectorXd>(limits.data(), torque_dim);
}

bool within(const std::vector<double>& limits, const std::vector<double>& outer) {
  const size_t count = std::max(limits.size(), outer.size());
  if ((limits.size() != 1 && limits.size() != count) ||
      (outer.size() != 1 && outer.size() != count))
    return false;
  for (size_t i = 0; i < count; ++i) {
    if (!(limits[limits.size() == 1 ? 0 : i] <= outer[outer.size() == 1 ? 0 : i])) return false;
  }
  return true;
}

std::string limitsText(const std::vector<double>& limits) {
  std::string text;
  for (const double limit : limits) text += textOf(text.empty() ? "" : ", ", limit);
  return limits.size() == 1 ? text : "[" + text + "]";
}

bool areLimits(const std::vector<double>& limits) {
  return !limits.empty() && std::all_of(limits.begin(), limits.end(), isPositive);
}

}  // namespace ddm
