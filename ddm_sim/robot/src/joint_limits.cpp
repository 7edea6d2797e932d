// Checks the joint states of a robot against limits.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/joint_limits.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>

namespace ddm {

JointLimits::JointLimits(const RobotOptions& options)
    : position_limits_(options.position_limits),
      speed_limit_(options.speed_limit),
      named_(!options.joints.empty()),
      joints_(std::max(position_limits_.size(), speed_limit_.size())) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    joints_[i].name = named_ ? options.joints[i] : "number " + std::to_string(i);
  }
}

void JointLimits::take(const JointReport& report) {
  const std::size_t num_reported = std::max(report.positions.size(), report.velocities.size());
  unfit_.clear();
  if (!named_ && num_reported != joints_.size()) {
    unfit_ = textOf("joint_states reports ", num_reported, " joint(s) where limits are set for ",
                    joints_.size(), ": name the joints that have limits in robot/joints");
    return;
  }
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    std::size_t index = i;
    if (named_) {
      const auto found = std::find(report.names.begin(), report.names.end(), joint.name);
      if (found == report.names.end()) continue;
      index = static_cast<std::size_t>(found - report.names.begin());
    }
    const std::string rivalry = findRival(&joint, report.arrival, report.reporter);
    if (!rivalry.empty()) joint.violation = rivalry;
    joint.refusal = joint.stamps.take(report.arrival, report.clock, report.stamp);
    if (!joint.refusal.empty()) {
      joint.stamps.restart();  // compares the next stamp with the clock of this machine
      continue;
    }
    joint.heard = joint.stamps.taken();
    if (index < report.positions.size() && report.positions[index] != joint.position) {
      joint.position = report.positions[index];
      joint.torques_since_change = 0;
    }
    joint.violation = rivalry.empty() ? check(i, index, report) : rivalry;
  }
}

void JointLimits::torqueChanges() {
  for (Joint& joint : joints_) ++joint.torques_since_change;
}

std::string JointLimits::frozen() const {
  for (std::size_t i = 0; i < position_limits_.size(); ++i) {
    if (joints_[i].torques_since_change < kFrozenTorques) continue;
    return textOf("joint_states has reported joint ", joints_[i].name, " at exactly ",
                  joints_[i].position, " while ", joints_[i].torques_since_change,
                  " torques acted: make sure that its driver measures it, and that nothing holds "
                  "the joint");
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

/// @param joint  index of the joint in joints_
/// @param index  index of the joint in the report
std::string JointLimits::check(std::size_t joint, std::size_t index,
                               const JointReport& report) const {
  const std::string& name = joints_[joint].name;
  const auto isWithin = [](double value, double lower, double upper) {  // false for NaN
    return std::isfinite(value) && value >= lower && value <= upper;
  };
  const bool needs_position = joint < position_limits_.size();
  if (needs_position && index >= report.positions.size()) {
    return "joint_states has no position of joint " + name + ", which robot/position_limits needs";
  }
  const bool needs_speed = joint < speed_limit_.size();
  if (needs_speed && index >= report.velocities.size()) {
    return "joint_states has no velocity of joint " + name + ", which robot/speed_limit needs";
  }
  if (needs_position) {
    const double lower = position_limits_[joint][0], upper = position_limits_[joint][1];
    const double position = report.positions[index];
    if (!isWithin(position, lower, upper)) {
      return textOf("joint ", name, " is at ", position, ", robot/position_limits allows ", lower,
                    " to ", upper, ": move it back by hand");
    }
  }
  if (needs_speed) {
    const double limit = speed_limit_[joint], speed = report.velocities[index];
    if (!isWithin(speed, -limit, limit)) {
      return textOf("joint ", name, " moves at ", speed, ", robot/speed_limit allows ", limit,
                    ": let it come to rest");
    }
  }
  return "";
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
    return textOf("joint_states has not reported joint ", joint.name, " for ", toSeconds(kSilence),
                  " s, and it has limits", joint.refusal.empty() ? "" : ": ", joint.refusal);
  }
  return "";
}

}  // namespace ddm
