// Checks the joint states of a robot against limits.
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

void JointLimits::take(const JointReport& report) {
  const std::size_t num_reported = std::max(report.positions.size(), report.velocities.size());
  unfit_.clear();
  if (!named_ && num_reported != joints_.size()) {
    std::ostringstream text;
    text << "joint_states reports " << num_reported << " joint(s) where limits are set for "
         << joints_.size() << ": name the joints that have limits in robot/joints";
    unfit_ = text.str();
    return;
  }
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    std::size_t index = i;
    if (named_) {
      const auto found = std::find(report.names.begin(), report.names.end(), joints_[i].name);
      if (found == report.names.end()) continue;
      index = static_cast<std::size_t>(found - report.names.begin());
    }
    take(report, index, &joints_[i]);
  }
}

void JointLimits::take(const JointReport& report, std::size_t index, Joint* joint) {
  const std::string rivalry = findRival(joint, report.arrival, report.reporter);
  if (!rivalry.empty()) joint->violation = rivalry;
  joint->refusal = joint->stamps.take(report.arrival, report.clock, report.stamp);
  if (!joint->refusal.empty()) {
    joint->stamps.restart();  // compares the next stamp with the clock of this machine
    return;
  }
  joint->heard = joint->stamps.taken();
  if (index < report.positions.size() && report.positions[index] != joint->position) {
    joint->position = report.positions[index];
    joint->torques_since_change = 0;
  }
  joint->violation = rivalry.empty() ? check(*joint, index, report) : rivalry;
}

void JointLimits::torqueChanges() {
  for (Joint& joint : joints_) ++joint.torques_since_change;
}

std::string JointLimits::frozen() const {
  for (const Joint& joint : joints_) {
    if (!joint.has_position_limits || joint.torques_since_change < kFrozenTorques) continue;
    std::ostringstream text;
    text << "joint_states has reported joint " << joint.name << " at exactly " << joint.position
         << " while " << joint.torques_since_change
         << " torques acted: make sure that its driver measures it, and that nothing holds the "
            "joint";
    return text.str();
  }
  return "";
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

std::string JointLimits::check(const Joint& joint, std::size_t index, const JointReport& report) {
  const std::vector<double>& positions = report.positions;
  const std::vector<double>& velocities = report.velocities;
  const auto within = [](double value, double lower, double upper) {  // false for NaN
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
    if (!joint.refusal.empty()) text << ": " << joint.refusal;
    return text.str();
  }
  return "";
}

}  // namespace ddm
