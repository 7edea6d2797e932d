// Torque limits: one number for all motors, or one number for each motor.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

/// Expands limits to one number for each motor.
/// @param limits  one number for all motors, or one for each motor
/// @param key     name of the parameter in the error message, such as "model/max_torque"
/// @return        [torque_dim]
/// @throws std::invalid_argument for any other number of limits
Eigen::VectorXd perMotor(const std::vector<double>& limits, int torque_dim, const std::string& key);

/// @return whether each motor's limit in `limits` is at most its limit in `outer`; false if both
///         have several numbers, but not equally many
bool within(const std::vector<double>& limits, const std::vector<double>& outer);

/// @return limits as a YAML file has them: "6", "[4, 2]"
std::string limitsText(const std::vector<double>& limits);

/// @return whether there is at least one limit and all limits are positive and finite
bool areLimits(const std::vector<double>& limits);

}  // namespace ddm
