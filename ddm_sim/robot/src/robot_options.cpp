// Parameters of a robot: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/robot_options.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace ddm {
namespace {

std::string textOf(const std::vector<double>& values) {
  std::ostringstream out;
  out << "[";
  for (const double value : values) out << (out.tellp() > 1 ? ", " : "") << value;
  out << "]";
  return out.str();
}

}  // namespace

std::vector<std::string> RobotOptions::problems() const {
  std::vector<std::string> out;
  const auto require = [&out](bool ok, const char* rule, double value) {
    if (ok) return;
    std::ostringstream text;
    text << "robot/" << rule << ", got " << value;
    out.push_back(text.str());
  };
  require(dt >= 0.001 && dt <= 10.0, "dt must lie in [0.001, 10]", dt);
  require(crop_x >= 0 && crop_x < 16384, "crop_x must lie in [0, 16383]", crop_x);
  require(crop_y >= 0 && crop_y < 16384, "crop_y must lie in [0, 16383]", crop_y);
  require(crop_width >= 0 && crop_width <= 16384, "crop_width must lie in [0, 16384]", crop_width);
  require(crop_height >= 0 && crop_height <= 16384, "crop_height must lie in [0, 16384]",
          crop_height);
  require(effort_rate >= 1.0 && effort_rate <= 1000.0, "effort_rate must lie in [1, 1000]",
          effort_rate);
  require(reset_timeout > 0.0 && std::isfinite(reset_timeout), "reset_timeout must be > 0",
          reset_timeout);
  for (const std::string& problem : problemsOfMotors()) out.push_back(problem);
  for (const std::string& problem : problemsOfLimits()) out.push_back(problem);
  return out;
}

std::vector<std::string> RobotOptions::problemsOfMotors() const {
  std::vector<std::string> out;
  const auto all = [](const std::vector<double>& values, auto rule) {  // false for NaN
    return std::all_of(values.begin(), values.end(),
                       [rule](double value) { return rule(value) && std::isfinite(value); });
  };
  if (max_torque.empty() || !all(max_torque, [](double value) { return value > 0.0; })) {
    out.push_back("robot/max_torque must be > 0, one number for each motor, got " +
                  textOf(max_torque));
  }
  if (!all(slew_rate, [](double value) { return value >= 0.0; })) {
    out.push_back("robot/slew_rate must be >= 0, got " + textOf(slew_rate));
  }
  if (slew_rate.size() != 1 && slew_rate.size() != max_torque.size()) {
    out.push_back("robot/slew_rate must have one number, or one for each motor as " +
                  std::string("robot/max_torque has, ") + std::to_string(max_torque.size()) +
                  ", got " + std::to_string(slew_rate.size()));
  }
  return out;
}

std::vector<std::string> RobotOptions::problemsOfLimits() const {
  std::vector<std::string> out;
  for (const std::vector<double>& limits : position_limits) {
    if (limits.size() == 2 && limits[0] < limits[1]) continue;
    out.push_back("robot/position_limits must be a list of [lower, upper], lower < upper, got " +
                  textOf(limits) + " in it");
  }
  for (const double limit : speed_limit) {
    if (limit > 0.0) continue;
    out.push_back("robot/speed_limit must be > 0 for each joint, got " + textOf(speed_limit));
    break;
  }
  const auto requireEach = [&out](const char* key, std::size_t size, const char* of,
                                  std::size_t count) {
    if (size == 0 || count == 0 || size == count) return;
    out.push_back(std::string("robot/") + key + " must have as many entries as robot/" + of + ", " +
                  std::to_string(count) + ", got " + std::to_string(size));
  };
  if (!joints.empty() && position_limits.empty() && speed_limit.empty()) {
    out.push_back("robot/joints names joints without robot/position_limits or robot/speed_limit");
  }
  requireEach("position_limits", position_limits.size(), "joints", joints.size());
  requireEach("speed_limit", speed_limit.size(), "joints", joints.size());
  requireEach("speed_limit", speed_limit.size(), "position_limits", position_limits.size());
  return out;
}

}  // namespace ddm
