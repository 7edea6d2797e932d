// Real time: the plant moves by itself every dt, as a robot does.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib_msgs/GoalID.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_srvs/Trigger.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ddm_msgs/topics.h"
#include "sim_node.h"

namespace ddm {
namespace {

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
/// something is wired wrongly. The plant begins at rest; a reset sets the state at any time, and its
/// num_steps has no effect.
///
/// It is also the simulated robot of robot_check.launch, with what robot_node needs of a robot: while
/// no node publishes torques it follows efforts, each of which is a torque without an image, and the
/// service `bring_to_start` resets it.
class RealtimeSim : public SimNode {
 public:
  RealtimeSim(ros::NodeHandle nh, std::unique_ptr<Environment> environment)
      : SimNode(nh, std::move(environment)),
        cancel_pub_(
            nh.advertise<actionlib_msgs::GoalID>(std::string(topics::kRunTrial) + "/cancel", 1)) {
    if (this->plant().torqueDim() == 1) {
      effort_sub_ = nh.subscribe(topics::kEffortCommand, kQueueSize, &RealtimeSim::onEffort, this,
                                 ros::TransportHints().tcpNoDelay());
    } else {
      effort_sub_ = nh.subscribe(topics::kGroupEffortCommand, kQueueSize, &RealtimeSim::onEfforts,
                                 this, ros::TransportHints().tcpNoDelay());
    }
    start_server_ = nh.advertiseService("bring_to_start", &RealtimeSim::onBringToStart, this);
    switchMotorOff();
    publishGoal(wallNow());
    timer_ = nh.createSteadyTimer(ros::WallDuration(this->plant().info().dt), &RealtimeSim::onTick,
                                  this);
  }

 private:
  // Without a newer torque the motor is off from the third step on.
  static constexpr int kMaxStepsHeld = 2;
  static constexpr int kQueueSize = 10;

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
    showImage(stamp);
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

  void onEffort(const std_msgs::Float64& effort) { follow({effort.data}); }
  void onEfforts(const std_msgs::Float64MultiArray& efforts) { follow(efforts.data); }
  void follow(const std::vector<double>& efforts) {
    if (torques().getNumPublishers() > 0) return;
    ddm_msgs::Torque torque;
    torque.header.stamp = wallNow();
    torque.torque = efforts;
    handleTorque(torque, "a node", effort_sub_.getTopic());
  }

  bool onBringToStart(std_srvs::Trigger::Request& /*request*/,
                      std_srvs::Trigger::Response& response) {
    ddm_msgs::Reset reset;
    reset.request.trial = num_starts_++;
    onReset(reset.request, reset.response);
    response.success = reset.response.success;
    response.message = reset.response.message;
    return true;
  }

  void switchMotorOff() {
    held_ = Eigen::VectorXd::Zero(plant().torqueDim());
    held_stamp_ = ros::Time();
    answer_.torque.clear();
  }

  void showImage(const ros::Time& stamp) {
    shown_ = publishImage(stamp);
    answer_ = ddm_msgs::Torque();
    answer_.header.stamp = stamp;
    publishGroundTruth();
  }

  /// The time in which the last image could be answered is over.
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
    showImage(wallNow());
  }

  Eigen::VectorXd held_;          ///< newest torque, zero when the motor is off
  ros::Time held_stamp_;          ///< of the image that held_ answers, zero when the motor is off
  int steps_held_ = 0;            ///< steps taken under held_
  bool shown_ = false;            ///< the camera has not lost the last image
  ddm_msgs::Torque answer_;       ///< to the last image so far; without a torque if there is none
  bool stopped_ = false;          ///< by a torque that was refused
  std::uint32_t num_starts_ = 0;  ///< calls of bring_to_start
  ros::Publisher cancel_pub_;
  ros::Subscriber effort_sub_;
  ros::ServiceServer start_server_;
  ros::SteadyTimer timer_;
};

}  // namespace

std::unique_ptr<SimNode> makeRealtimeSim(const ros::NodeHandle& nh,
                                         std::unique_ptr<Environment> environment) {
  return std::make_unique<RealtimeSim>(nh, std::move(environment));
}

}  // namespace ddm
