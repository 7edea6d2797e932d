// Limits of a robot's joints, and whether its reports keep them.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/joint_limits.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace ddm {

JointLimits::JointLimits(const RobotOptions& options) : named_(!options.joints.empty()) {
  const std::size_t count = std::max(options.position_limits.size(), options.speed_limit.size());
  for (std::size_t i = 0; i < count; ++i) {
    Joint joint;
    joint.name = named_ ? options.joints[i] : "number " + std::to_string(i);
    joint.has_position_limits = i < options.position_limits.size();
    if (joint.has_position_limits) {
      joint.lower = options.position_limits[i][0];
      joint.upper = options.position_limits[i][1];
    }
    joint.has_speed_limit = i < options.speed_limit.size();
    if (joint.has_speed_limit) joint.speed_limit = options.speed_limit[i];
    joints_.push_back(joint);
  }
}

void JointLimits::take(SteadyTime now, const std::string& reporter,
                       const std::vector<std::string>& names, const std::vector<double>& positions,
                       const std::vector<double>& velocities) {
  const std::size_t num_reported = std::max(positions.size(), velocities.size());
  unfit_.clear();
  if (!named_ && num_reported != joints_.size()) {
    std::ostringstream text;
    text << "joint_states reports " << num_reported << " joint(s) where limits are set for "
         << joints_.size() << ": name those that have limits in robot/joints";
    unfit_ = text.str();
    return;
  }
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    std::size_t index = i;
    if (named_) {
      const auto found = std::find(names.begin(), names.end(), joints_[i].name);
      if (found == names.end()) continue;
      index = static_cast<std::size_t>(found - names.begin());
    }
    joints_[i].violation = findRival(&joints_[i], now, reporter);
    joints_[i].heard = now;
    if (joints_[i].violation.empty()) {
      joints_[i].violation = check(joints_[i], index, positions, velocities);
    }
  }
}

std::string JointLimits::findRival(Joint* joint, SteadyTime now, const std::string& reporter) {
  if (joint->reporter != reporter && joint->heard != SteadyTime() &&
      now - joint->heard <= kTakeover) {
    joint->rival = joint->reporter;
    joint->contested = now;
  }
  joint->reporter = reporter;
  if (joint->contested == SteadyTime() || now - joint->contested > kTakeover) return "";
  return "joint " + joint->name + " is reported on joint_states by " + joint->rival + " and by " +
         reporter + ": only its driver should";
}

std::string JointLimits::check(const Joint& joint, std::size_t index,
                               const std::vector<double>& positions,
                               const std::vector<double>& velocities) {
  const auto within = [](double value, double lower, double upper) {  // never so for NaN
    return std::isfinite(value) && value >= lower && value <= upper;
  };
  std::ostringstream text;
  if (joint.has_position_limits && index >= positions.size()) {
    text << "joint_states has no position of joint " << joint.name
         << ", which robot/position_limits needs";
  } else if (joint.has_speed_limit && index >= velocities.size()) {
    text << "joint_states has no velocity of joint " << joint.name
         << ", which robot/speed_limit needs";
  } else if (joint.has_position_limits && !within(positions[index], joint.lower, joint.upper)) {
    text << "joint " << joint.name << " is at " << positions[index]
         << ", robot/position_limits allows " << joint.lower << " to " << joint.upper
         << ": move it back by hand";
  } else if (joint.has_speed_limit &&
             !within(velocities[index], -joint.speed_limit, joint.speed_limit)) {
    text << "joint " << joint.name << " moves at " << velocities[index]
         << ", robot/speed_limit allows " << joint.speed_limit << ": let it come to rest";
  }
  return text.str();
}

std::string JointLimits::violation() const {
  if (!unfit_.empty()) return unfit_;
  for (const Joint& joint : joints_) {
    if (!joint.violation.empty()) return joint.violation;
  }
  return "";
}

std::string JointLimits::silence(SteadyTime now) const {
  for (const Joint& joint : joints_) {
    if (joint.heard != SteadyTime() && now - joint.heard <= kSilence) continue;
    std::ostringstream text;
    text << "joint_states has not reported joint " << joint.name << " for " << toSeconds(kSilence)
         << " s, and it has limits";
    return text.str();
  }
  return "";
}

}  // namespace ddm
