// Rules for the parameters of a robot.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/robot_options.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <set>
#include <sstream>

namespace ddm {

std::string listText(const std::vector<double>& values) {
  std::ostringstream out;
  out << "[";
  for (const double value : values) out << (out.tellp() > 1 ? ", " : "") << value;
  out << "]";
  return out.str();
}

std::vector<std::string> RobotOptions::problems() const {
  OptionChecks robot("robot");
  robot.requireWithin("dt", dt, 0.001, 10.0);
  robot.require(crop.size() == 4 && std::all_of(crop.begin(), crop.end(),
                                                [](int v) { return v >= 0 && v <= 16384; }),
                "crop", "be [column, row, width, height], each in [0, 16384]",
                listText(std::vector<double>(crop.begin(), crop.end())));
  robot.require(!max_torque.empty(), "max_torque", "have a number for each motor", "none");
  for (const double limit : max_torque) robot.requirePositive("max_torque", limit);
  for (const double limit : slew_rate) robot.requireNotNegative("slew_rate", limit);
  robot.require(slew_rate.size() == 1 || slew_rate.size() == max_torque.size(), "slew_rate",
                "have one number, or one for each motor as robot/max_torque has, " +
                    std::to_string(max_torque.size()),
                slew_rate.size());
  robot.requireWithin("max_hold", max_hold, 0.001, 20.0);
  robot.requireTimeLimit("reset_timeout", reset_timeout);

  for (const std::vector<double>& limits : position_limits) {
    robot.require(limits.size() == 2 && limits[0] < limits[1], "position_limits",
                  "be a list of [lower, upper], lower < upper", listText(limits) + " in it");
  }
  for (const double limit : speed_limit) {
    robot.require(limit > 0.0, "speed_limit", "be > 0 for each joint", limit);
  }
  const std::size_t num_limits = std::max(position_limits.size(), speed_limit.size());
  robot.require(joints.empty() || num_limits > 0, "joints",
                "be empty without robot/position_limits and robot/speed_limit", joints.size());
  robot.require(num_limits < 2 || !joints.empty(), "joints",
                "name the joints that have limits, in the order of the limits, where there is more "
                "than one",
                "none for " + std::to_string(num_limits));
  robot.require(std::set<std::string>(joints.begin(), joints.end()).size() == joints.size(),
                "joints", "name each joint once", "a name twice");
  const auto requireOneForEachJoint = [&](const std::string& key, std::size_t size) {
    robot.require(size == 0 || joints.empty() || size == joints.size(), key,
                  "have as many entries as robot/joints, " + std::to_string(joints.size()), size);
  };
  requireOneForEachJoint("position_limits", position_limits.size());
  requireOneForEachJoint("speed_limit", speed_limit.size());
  return robot.problems();
}

}  // namespace ddm
