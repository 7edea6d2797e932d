// Real time: the plant moves by itself every dt, as a robot would.
// SPDX-License-Identifier: BSD-3-Clause
#include "realtime_sim.h"

#include <actionlib_msgs/GoalID.h>

#include <utility>

#include "ddm_msgs/topics.h"

namespace ddm {
namespace {

constexpr int kMaxStepsHeld = 2;  // without a newer torque the motor is off from the third step on

ros::Time wallNow() {  // ros::Time::now() would follow /clock if somebody else published one
  const ros::WallTime now = ros::WallTime::now();
  return ros::Time(now.sec, now.nsec);
}

}  // namespace

RealtimeSim::RealtimeSim(ros::NodeHandle nh, std::unique_ptr<Rig> rig)
    : SimNode(nh, std::move(rig), /*clock=*/false),
      cancel_pub_(
          nh.advertise<actionlib_msgs::GoalID>(std::string(topics::kRunTrial) + "/cancel", 1)) {
  switchMotorOff();
  publishGoal(wallNow());
  timer_ =
      nh.createSteadyTimer(ros::WallDuration(this->plant().info().dt), &RealtimeSim::onTick, this);
}

ros::Time RealtimeSim::beginTrial(const ddm_msgs::Reset::Request& request) {
  stopped_ = false;
  switchMotorOff();  // the torque on hold was meant for another state
  timer_.stop();     // stop and start, so that the first step is a whole one
  timer_.start();
  const ros::Time stamp = wallNow();
  publishGoal(stamp);
  settleAnswer();
  showFrame(stamp);
  ROS_INFO("%s %u starts in real time", request.evaluation ? "evaluation" : "trial", request.trial);
  return stamp;
}

void RealtimeSim::takeTorque(const ddm_msgs::Torque& message, const Eigen::VectorXd& torque,
                             const std::string& /*publisher*/) {
  if (stopped_ || message.header.stamp < held_stamp_) return;
  held_stamp_ = message.header.stamp;
  answer_.torque.clear();
  if (message.header.stamp == answer_.header.stamp) answer_ = message;
  held_ = torque;
  steps_held_ = 0;
}

void RealtimeSim::torqueRefused(const ros::Time& /*stamp*/, const std::string& /*reason*/) {
  switchMotorOff();
  if (stopped_) return;
  stopped_ = true;
  ROS_ERROR("the motor is off until the next reset, and the trial is cancelled");
  cancel_pub_.publish(actionlib_msgs::GoalID());  // without an id: all goals
}

void RealtimeSim::switchMotorOff() {
  held_ = Eigen::VectorXd::Zero(plant().torqueDim());
  held_stamp_ = ros::Time();
  answer_.torque.clear();
}

void RealtimeSim::showFrame(const ros::Time& stamp) {
  shown_ = publishFrame(stamp);
  answer_ = ddm_msgs::Torque();
  answer_.header.stamp = stamp;
  publishGroundTruth();
}

/// The time in which the last frame could be answered is over.
void RealtimeSim::settleAnswer() {
  if (shown_) publishApplied(answer_);
}

void RealtimeSim::onTick(const ros::SteadyTimerEvent& /*event*/) {
  if (++steps_held_ > kMaxStepsHeld) switchMotorOff();
  if (!advance(held_)) {
    timer_.stop();
    return;
  }
  settleAnswer();
  showFrame(wallNow());
}

}  // namespace ddm
