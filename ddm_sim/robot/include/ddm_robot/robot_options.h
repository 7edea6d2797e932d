// Parameters of a robot: camera, motors, start and goal. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace ddm {

/// "[1, 2]", for messages.
inline std::string listText(const std::vector<double>& values) {
  std::ostringstream out;
  out << "[";
  for (const double value : values) out << (out.tellp() > 1 ? ", " : "") << value;
  out << "]";
  return out.str();
}

/// Block `robot`.
struct RobotOptions {
  double dt = 0.2;      ///< time step: one image and one torque each [s]
  int crop_x = 0;       ///< what counts of the camera's image: first column [pixels]
  int crop_y = 0;       ///< first row [pixels]
  int crop_width = 0;   ///< columns; 0: to the right edge [pixels]
  int crop_height = 0;  ///< rows; 0: to the bottom [pixels]
  std::vector<double> max_torque = {6.0};  ///< bound on the torque of each motor [N m]
  std::vector<double> slew_rate = {0.0};   ///< bound on its change, or one for all; 0: none [N m/s]
  std::vector<std::string> joints;  ///< names of those that have limits, in the order of the limits
  std::vector<std::vector<double>> position_limits;  ///< [lower, upper] of each [rad or m]
  std::vector<double> speed_limit;                   ///< of each [rad/s or m/s]
  double max_hold = 0.5;         ///< how long a torque acts at most, whatever dt is [s]
  double effort_rate = 100.0;    ///< how often torques are sent and timeouts checked [Hz]
  std::string goal_file;         ///< picture of the goal; take_goal writes it
  std::string reset_service;     ///< std_srvs/Trigger that brings it to its start; empty: a person
  double reset_timeout = 300.0;  ///< time that all of a reset may take [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("dt", dt);
    visitor("crop_x", crop_x);
    visitor("crop_y", crop_y);
    visitor("crop_width", crop_width);
    visitor("crop_height", crop_height);
    visitor("max_torque", max_torque);
    visitor("slew_rate", slew_rate);
    visitor("joints", joints);
    visitor("position_limits", position_limits);
    visitor("speed_limit", speed_limit);
    visitor("max_hold", max_hold);
    visitor("effort_rate", effort_rate);
    visitor("goal_file", goal_file);
    visitor("reset_service", reset_service);
    visitor("reset_timeout", reset_timeout);
  }
  /// Whether a torque may act for (nearly) all of a time step: otherwise nothing can be learned.
  bool holdsForAStep() const { return max_hold >= 0.9 * dt; }
  int numMotors() const { return static_cast<int>(max_torque.size()); }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
    OptionChecks robot("robot");
    robot.requireWithin("dt", dt, 0.001, 10.0);
    robot.requireWithin("crop_x", crop_x, 0, 16383);
    robot.requireWithin("crop_y", crop_y, 0, 16383);
    robot.requireWithin("crop_width", crop_width, 0, 16384);
    robot.requireWithin("crop_height", crop_height, 0, 16384);
    robot.requireWithin("max_hold", max_hold, 0.001, 20.0);
    robot.requireWithin("effort_rate", effort_rate, 20.0, 1000.0);
    robot.requireTimeLimit("reset_timeout", reset_timeout);
    checkMotors(&robot);
    checkLimits(&robot);
    return robot.problems();
  }

 private:
  void checkMotors(OptionChecks* robot) const {
    robot->require(!max_torque.empty(), "max_torque", "have a number for each motor", "none");
    for (const double limit : max_torque) robot->requirePositive("max_torque", limit);
    for (const double limit : slew_rate) robot->requireNotNegative("slew_rate", limit);
    robot->require(slew_rate.size() == 1 || slew_rate.size() == max_torque.size(), "slew_rate",
                   "have one number, or one for each motor as robot/max_torque has, " +
                       std::to_string(max_torque.size()),
                   slew_rate.size());
  }

  void checkLimits(OptionChecks* robot) const {
    for (const std::vector<double>& limits : position_limits) {
      robot->require(limits.size() == 2 && limits[0] < limits[1], "position_limits",
                     "be a list of [lower, upper], lower < upper", listText(limits) + " in it");
    }
    for (const double limit : speed_limit) {
      robot->require(limit > 0.0, "speed_limit", "be > 0 for each joint", limit);
    }
    robot->require(joints.empty() || !position_limits.empty() || !speed_limit.empty(), "joints",
                   "be empty without robot/position_limits and robot/speed_limit", joints.size());
    const auto requireEach = [robot](const std::string& key, std::size_t size,
                                     const std::string& of, std::size_t count) {
      robot->require(size == 0 || count == 0 || size == count, key,
                     "have as many entries as robot/" + of + ", " + std::to_string(count), size);
    };
    const std::size_t num_limits = std::max(position_limits.size(), speed_limit.size());
    robot->require(num_limits < 2 || !joints.empty(), "joints",
                   "name the joints that have limits, in the order of the limits, where there is "
                   "more than one",
                   "none for " + std::to_string(num_limits));
    robot->require(std::set<std::string>(joints.begin(), joints.end()).size() == joints.size(),
                   "joints", "name each joint once", "a name twice");
    requireEach("position_limits", position_limits.size(), "joints", joints.size());
    requireEach("speed_limit", speed_limit.size(), "joints", joints.size());
  }
};

}  // namespace ddm
