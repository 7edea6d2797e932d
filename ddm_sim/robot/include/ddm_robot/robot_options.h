// Parameters of a robot: camera, motors, initial state and goal. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// "[1, 2]", for messages.
std::string listText(const std::vector<double>& values);

/// Block `robot`.
struct RobotOptions {
  double dt = 0.2;                      ///< time step: one image and one torque each [s]
  std::vector<int> crop{0, 0, 0, 0};    ///< of the camera's images: column, row, width, height
                                        ///< [pixels]; a width or height of 0 reaches to the edge
  std::vector<double> max_torque{6.0};  ///< bound on the torque of each motor [N m]
  std::vector<double> slew_rate{0.0};   ///< bound on its change, or one for all; 0: none [N m/s]
  std::vector<std::string> joints;  ///< names of those that have limits, in the order of the limits
  std::vector<std::vector<double>> position_limits;  ///< [lower, upper] of each [rad or m]
  std::vector<double> speed_limit;                   ///< of each [rad/s or m/s]
  double max_hold = 0.5;         ///< how long a torque acts at most, whatever dt is [s]
  std::string goal_file;         ///< image of the goal; take_goal writes it
  std::string reset_service;     ///< std_srvs/Trigger that brings the robot to its initial state;
                                 ///< empty: a person does
  double reset_timeout = 300.0;  ///< time that all of a reset may take [s]

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
  /// Whether a torque may act for (nearly) all of a time step: otherwise nothing can be learned.
  bool holdsForAStep() const { return max_hold >= 0.9 * dt; }
  int numMotors() const { return static_cast<int>(max_torque.size()); }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

}  // namespace ddm
