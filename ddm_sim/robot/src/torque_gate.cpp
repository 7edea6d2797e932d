// The gate between a controller and the motors: decides which torque the motors receive.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/torque_gate.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace ddm {
namespace {

constexpr char kNoListener[] =
    "no node subscribes to the efforts, so that torques cannot act: start the effort controller. "
    "It must take std_msgs/Float64 for one motor, Float64MultiArray for several, and reach this "
    "machine, see ROS_IP";

}  // namespace

TorqueGate::TorqueGate(const RobotOptions& options)
    : max_torque_(options.max_torque),
      slew_rate_(options.slew_rate),
      dt_(fromSeconds(options.dt)),
      max_hold_(fromSeconds(options.max_hold)),
      holds_for_a_step_(options.holdsForAStep()),
      joints_(options),
      target_(max_torque_.size(), 0.0),
      effort_(max_torque_.size(), 0.0) {
  if (slew_rate_.size() == 1) slew_rate_.assign(max_torque_.size(), options.slew_rate.front());
}

std::string TorqueGate::fault(SteadyTime now) const {
  if (num_publishers_ > 1) {
    return std::to_string(num_publishers_) + " nodes publish torques: end all but one";
  }
  if (num_listeners_ == 0) return kNoListener;
  const std::string silence = joints_.silence(now);
  return silence.empty() ? joints_.violation() : silence;
}

std::string TorqueGate::arm(SteadyTime now) {
  const std::string problem = fault(now);
  if (problem.empty() && state_ == State::kStopped) wait();
  return problem;
}

void TorqueGate::stop(const std::string& reason) {
  wait();
  state_ = State::kStopped;
  stop_reason_ = reason;
}

void TorqueGate::beginReset() {
  resetting_ = true;
  if (armed()) wait();
}

void TorqueGate::endReset() {
  resetting_ = false;
  if (armed()) wait();
}

void TorqueGate::endTrial() {
  if (inTrial()) wait();
}

/// Sets zero torque, and gives up the images whose torque is not due yet.
void TorqueGate::wait() {
  state_ = resetting_ ? State::kResetting : State::kWaiting;
  while (!pending_.empty()) giveUpFirst();
  setZero();
}

void TorqueGate::setZero() {
  std::fill(target_.begin(), target_.end(), 0.0);
  std::fill(effort_.begin(), effort_.end(), 0.0);
}

void TorqueGate::giveUpFirst() {
  unanswered_.push_back(pending_.front().stamp);
  pending_.pop_front();
}

std::vector<Stamp> TorqueGate::takeUnanswered() {
  std::vector<Stamp> taken;
  taken.swap(unanswered_);
  return taken;
}

void TorqueGate::showImage(SteadyTime taken, Stamp stamp) {
  pending_.push_back({stamp, taken});
  last_image_ = taken;
}

bool TorqueGate::takeTorque(SteadyTime now, Stamp stamp, const std::vector<double>& torque) {
  expire(now);
  if (!armed()) return false;
  const bool is_finite =
      std::all_of(torque.begin(), torque.end(), [](double value) { return std::isfinite(value); });
  if (torque.size() != max_torque_.size() || !is_finite) {
    stop("a torque must be " + std::to_string(max_torque_.size()) +
         " finite number(s) [N m], one for each motor, got " + listText(torque));
    return false;
  }
  if (num_listeners_ == 0) {
    stop(kNoListener);
    return false;
  }
  if (state_ == State::kResetting || !joints_.silence(now).empty()) return false;
  if (!joints_.violation().empty()) {
    stop(joints_.violation());
    return false;
  }
  const auto image = std::find_if(pending_.begin(), pending_.end(),
                                  [stamp](const Pending& each) { return each.stamp == stamp; });
  if (image == pending_.end()) return false;
  if (inTrial()) num_misses_ += static_cast<int>(image - pending_.begin());
  while (pending_.front().stamp != stamp) giveUpFirst();
  pending_.pop_front();
  ++num_answers_;
  state_ = State::kFollowing;
  last_torque_ = now;
  const std::vector<double> before = target_;
  for (std::size_t i = 0; i < torque.size(); ++i) {
    target_[i] = std::clamp(torque[i], -max_torque_[i], max_torque_[i]);
  }
  if (target_ != before) joints_.torqueChanges();
  return true;
}

void TorqueGate::takeJoints(const JointReport& report) {
  joints_.take(report);
  if (inTrial() && !joints_.violation().empty()) stop(joints_.violation());
}

void TorqueGate::setPublishers(int num_publishers) {
  num_publishers_ = num_publishers;
  if (num_publishers > 1 && armed()) {
    stop(std::to_string(num_publishers) + " nodes publish torques, one must");
  }
  if (num_publishers == 0 && state_ == State::kFollowing) state_ = State::kNoController;
}

void TorqueGate::setListeners(int num_listeners) {
  num_listeners_ = num_listeners;
  if (num_listeners == 0 && inTrial()) stop(kNoListener);
}

/// Changes the state if an image, a torque or a joint state is overdue.
void TorqueGate::expire(SteadyTime now) {
  while (!pending_.empty() && now - pending_.front().taken > dt_) {
    giveUpFirst();
    if (!inTrial()) continue;
    ++num_misses_;
    state_ = State::kLate;
  }
  if (state_ == State::kFollowing && now - last_image_ > 2 * dt_) state_ = State::kImagesStopped;
  if (state_ == State::kFollowing && now - last_torque_ >= max_hold_) state_ = State::kHeldTooLong;
  if (inTrial() && !joints_.silence(now).empty()) state_ = State::kJointsSilent;
}

const std::vector<double>& TorqueGate::effort(SteadyTime now) {
  expire(now);
  const double passed = toSeconds(now - last_effort_);
  last_effort_ = now;
  if (state_ != State::kFollowing) setZero();
  for (std::size_t i = 0; i < effort_.size(); ++i) {
    const double step = slew_rate_[i] * passed;
    const double change = target_[i] - effort_[i];
    effort_[i] =
        slew_rate_[i] == 0.0 ? target_[i] : effort_[i] + std::max(-step, std::min(step, change));
  }
  return effort_;
}

std::string TorqueGate::describe() const {
  switch (state_) {
    case State::kStopped:
      return "the motors are off: " + stop_reason_;
    case State::kResetting:
      return "zero torque while the robot goes to its start";
    case State::kWaiting:
      return "zero torque, no trial is under way";
    case State::kFollowing:
      return "the motors follow the controller";
    case State::kImagesStopped:
      return "zero torque: no image came for two dt";
    case State::kLate:
      return "zero torque: an image had no torque within dt";
    case State::kNoController:
      return "zero torque: no node publishes torques";
    case State::kHeldTooLong:
      return "zero torque: the last torque has acted for robot/max_hold";
    case State::kJointsSilent:
      return "zero torque: joint_states does not report the joints that have limits";
  }
  return "";
}

}  // namespace ddm
