// Real time: the plant moves by itself every dt, as a robot would.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <actionlib_msgs/GoalID.h>

#include <memory>
#include <string>
#include <utility>

#include "ddm_msgs/topics.h"
#include "sim_node.h"

namespace ddm {

/// Every dt of wall time: step under the newest torque (zero-order hold), show an image, unless the
/// camera loses it.
///
/// A torque that comes before the next step acts in the whole of it. It is the answer to the last
/// image if it carries that stamp: with the step it is published as applied. Any other torque is
/// late: the image has no answer, and the torque acts unless the one on hold answers a newer image.
///
/// Stamps are wall time, all else goes by the monotonic clock, and no clock is published. A torque
/// acts for two periods at most: without a newer one the motor is switched off. A torque that is
/// refused switches it off at once, until the next reset, and cancels the trial: as on a robot,
/// something is wired wrongly. Starts at rest; a reset sets the state at any time, and its
/// num_steps has no effect.
class RealtimeSim : public SimNode {
 public:
  RealtimeSim(ros::NodeHandle nh, std::unique_ptr<Environment> environment)
      : SimNode(nh, std::move(environment), /*clock=*/false),
        cancel_pub_(
            nh.advertise<actionlib_msgs::GoalID>(std::string(topics::kRunTrial) + "/cancel", 1)) {
    switchMotorOff();
    publishGoal(wallNow());
    timer_ = nh.createSteadyTimer(ros::WallDuration(this->plant().info().dt), &RealtimeSim::onTick,
                                  this);
  }

 private:
  // Without a newer torque the motor is off from the third step on.
  static constexpr int kMaxStepsHeld = 2;

  static ros::Time wallNow() {  // ros::Time::now() would go by a clock that somebody publishes
    const ros::WallTime now = ros::WallTime::now();
    return ros::Time(now.sec, now.nsec);
  }

  ros::Time beginTrial(const ddm_msgs::Reset::Request& request) override {
    stopped_ = false;
    switchMotorOff();  // the torque on hold was meant for another state
    timer_.stop();     // stop and start, so that the first step is a whole one
    timer_.start();
    const ros::Time stamp = wallNow();
    publishGoal(stamp);
    settleAnswer();
    showFrame(stamp);
    ROS_INFO("%s %u starts in real time", request.evaluation ? "evaluation" : "trial",
             request.trial);
    return stamp;
  }

  void takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                  const std::string& /*publisher*/) override {
    if (stopped_ || message.header.stamp < held_stamp_) return;
    held_stamp_ = message.header.stamp;
    answer_.torque.clear();
    if (message.header.stamp == answer_.header.stamp) answer_ = message;
    held_ = torque;
    steps_held_ = 0;
  }

  void torqueRefused(const ros::Time& /*stamp*/, const std::string& reason) override {
    switchMotorOff();
    if (stopped_) return;
    stopped_ = true;
    ROS_ERROR_STREAM(
        reason << ". The motor is off until the next reset, and the trial is cancelled");
    cancel_pub_.publish(actionlib_msgs::GoalID());  // without an id: all goals
  }

  void switchMotorOff() {
    held_ = Eigen::VectorXd::Zero(plant().torqueDim());
    held_stamp_ = ros::Time();
    answer_.torque.clear();
  }

  void showFrame(const ros::Time& stamp) {
    shown_ = publishFrame(stamp);
    answer_ = ddm_msgs::Torque();
    answer_.header.stamp = stamp;
    publishGroundTruth();
  }

  /// The time in which the last frame could be answered is over.
  void settleAnswer() {
    if (shown_) publishApplied(answer_);
  }

  void onTick(const ros::SteadyTimerEvent& /*event*/) {
    if (++steps_held_ > kMaxStepsHeld) switchMotorOff();
    if (!advance(held_)) {
      timer_.stop();
      return;
    }
    settleAnswer();
    showFrame(wallNow());
  }

  Eigen::VectorXd held_;     ///< newest torque, zero when the motor is off
  ros::Time held_stamp_;     ///< of the image that held_ answers, zero when the motor is off
  int steps_held_ = 0;       ///< steps taken under held_
  bool shown_ = false;       ///< the camera has not lost the last frame
  ddm_msgs::Torque answer_;  ///< to the last frame, as it stands; without a torque: none
  bool stopped_ = false;     ///< by a torque that was refused
  ros::Publisher cancel_pub_;
  ros::SteadyTimer timer_;
};

}  // namespace ddm
