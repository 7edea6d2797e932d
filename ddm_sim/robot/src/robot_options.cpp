// Parameters of a robot: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/robot_options.h"

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
  robot.requireWithin("crop_x", crop_x, 0, 16383);
  robot.requireWithin("crop_y", crop_y, 0, 16383);
  robot.requireWithin("crop_width", crop_width, 0, 16384);
  robot.requireWithin("crop_height", crop_height, 0, 16384);
  robot.requireWithin("effort_rate", effort_rate, 1.0, 1000.0);
  robot.requirePositive("reset_timeout", reset_timeout);
  checkMotors(&robot);
  checkLimits(&robot);
  return robot.problems();
}

void RobotOptions::checkMotors(OptionChecks* robot) const {
  robot->require(!max_torque.empty(), "max_torque", "have a number for each motor", "none");
  for (const double limit : max_torque) robot->requirePositive("max_torque", limit);
  for (const double limit : slew_rate) robot->requireNotNegative("slew_rate", limit);
  robot->require(slew_rate.size() == 1 || slew_rate.size() == max_torque.size(), "slew_rate",
                 "have one number, or one for each motor as robot/max_torque has, " +
                     std::to_string(max_torque.size()),
                 slew_rate.size());
}

void RobotOptions::checkLimits(OptionChecks* robot) const {
  for (const std::vector<double>& limits : position_limits) {
    robot->require(limits.size() == 2 && limits[0] < limits[1], "position_limits",
                   "be a list of [lower, upper], lower < upper", listText(limits) + " in it");
  }
  for (const double limit : speed_limit) {
    robot->require(limit > 0.0, "speed_limit", "be > 0 for each joint", limit);
  }
  robot->require(joints.empty() || !position_limits.empty() || !speed_limit.empty(), "joints",
                 "be empty without robot/position_limits and robot/speed_limit", joints.size());
  const auto requireEach = [robot](const std::string& key, std::size_t size, const std::string& of,
                                   std::size_t count) {
    robot->require(size == 0 || count == 0 || size == count, key,
                   "have as many entries as robot/" + of + ", " + std::to_string(count), size);
  };
  requireEach("position_limits", position_limits.size(), "joints", joints.size());
  requireEach("speed_limit", speed_limit.size(), "joints", joints.size());
  requireEach("speed_limit", speed_limit.size(), "position_limits", position_limits.size());
}

}  // namespace ddm
