// Parameters of a robot: camera, motors, initial state and goal. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Formats numbers as "[1, 2]", for messages.
std::string listText(const std::vector<double>& values);

/// Block `robot`.
struct RobotOptions {
  double dt = 0.2;  ///< time step: one image and one torque each [s]
  /// Used part of the camera image: column, row, width, height [pixels]; width or height 0: to the
  /// edge.
  std::vector<int> crop{0, 0, 0, 0};
  std::vector<double> max_torque{6.0};  ///< bound on the torque of each motor [N m]
  /// Bound on the change of each torque, one number or one per motor; 0: no bound [N m/s]
  std::vector<double> slew_rate{0.0};
  std::vector<std::string> joints;  ///< names of the joints with limits, in the order of the limits
  std::vector<std::vector<double>> position_limits;  ///< [lower, upper] of each joint [rad or m]
  std::vector<double> speed_limit;                   ///< largest speed of each joint [rad/s or m/s]
  double max_hold = 0.5;  ///< longest time for which a torque acts, independent of dt [s]
  std::string goal_file;  ///< file of the goal image; service take_goal writes it
  /// std_srvs/Trigger service that moves the robot to its initial state; empty: a person does
  std::string reset_service;
  double reset_timeout = 300.0;  ///< time limit of a complete reset [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("dt", dt);
    visitor("crop", crop);
    visitor("max_torque", max_torque);
    visitor("slew_rate", slew_rate);
    visitor("joints", joints);
    visitor("position_limits", position_limits);
    visitor("speed_limit", speed_limit);
    visitor("max_hold", max_hold);
    visitor("goal_file", goal_file);
    visitor("reset_service", reset_service);
    visitor("reset_timeout", reset_timeout);
  }
  /// Whether max_hold lets a torque act for at least 90 % of a time step. Otherwise no sample has a
  /// torque that acted for the whole step, and the model cannot be trained.
  bool holdsForAStep() const { return max_hold >= 0.9 * dt; }
  int numMotors() const { return static_cast<int>(max_torque.size()); }
  std::vector<std::string> problems() const;
};

}  // namespace ddm
