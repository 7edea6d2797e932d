// Limits of motors: one number for all of them, or one for each.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

/// The same limits, one for each motor.
/// @param limits  one number, which holds for all motors, or one for each
/// @param key     what they are, for the message: "model/max_torque"
/// @return        [torque_dim]
/// @throws std::invalid_argument if there is another number of them
Eigen::VectorXd perMotor(const std::vector<double>& limits, int torque_dim, const std::string& key);

/// Whether no motor's limit is larger than its outer one. Where both have one number for each motor
/// there must be equally many.
bool within(const std::vector<double>& limits, const std::vector<double>& outer);

/// As in a YAML file: "6", "[4, 2]".
std::string limitsText(const std::vector<double>& limits);

/// Whether there is at least one limit, and all are positive and finite.
bool areLimits(const std::vector<double>& limits);

}  // namespace ddm
