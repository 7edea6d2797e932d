// Real time: the plant takes a step every dt of wall time, like a robot.
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

/// Takes a step in every dt of wall time under the newest torque (zero-order hold), and publishes
/// an image, unless the camera loses it.
///
/// A torque that arrives before the next step acts during the whole step. If the torque carries the
/// stamp of the last image, it is the answer to that image and is published as applied after the
/// step. Any other torque is late: the image then has no answer, and the late torque acts unless
/// the held torque answers a newer image.
///
/// Stamps are wall time, timers use the monotonic clock, and no clock is published. A torque acts
/// for two periods at most; without a newer torque the motor is then switched off. A refused torque
/// switches the motor off immediately until the next reset, and cancels the episode, because a
/// refused torque means that nodes are connected wrongly; robot_node does the same. The plant
/// begins at rest. A reset sets the state at any time, and its num_steps has no effect.
///
/// This node is also the simulated robot of robot_check.launch and has the interface that
/// robot_node expects of a robot. While no node publishes torques, the node follows efforts, which
/// are torques without an image. The service `bring_to_start` resets the simulated robot.
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
  // Without a newer torque, the motor is off from the third step on.
  static constexpr int kMaxStepsHeld = 2;
  static constexpr int kQueueSize = 10;

  static ros::Time wallNow() {  // unlike ros::Time::now(), independent of a published /clock
    const ros::WallTime now = ros::WallTime::now();
    return ros::Time(now.sec, now.nsec);
  }

  ros::Time beginTrial(const ddm_msgs::Reset::Request& request) override {
    stopped_ = false;
    switchMotorOff();  // because the held torque was planned for another state
    timer_.stop();     // restarts the period, so that the first step has the full length
    timer_.start();
    const ros::Time stamp = wallNow();
    publishGoal(stamp);
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
    cancel_pub_.publish(actionlib_msgs::GoalID());  // without an id: cancels all goals
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

  /// Publishes the torque that acted after the last image, because the time for its answer is over.
  /// Then publishes the next image.
  void showImage(const ros::Time& stamp) {
    if (shown_) publishApplied(answer_);
    shown_ = publishImage(stamp);
    answer_ = ddm_msgs::Torque();
    answer_.header.stamp = stamp;
    publishGroundTruth();
  }

  void onTick(const ros::SteadyTimerEvent& /*event*/) {
    if (++steps_held_ > kMaxStepsHeld) switchMotorOff();
    if (!advance(held_)) {
      timer_.stop();
      return;
    }
    showImage(wallNow());
  }

  Eigen::VectorXd held_;     ///< newest torque, zero when the motor is off
  ros::Time held_stamp_;     ///< stamp of the image that held_ answers, zero when the motor is off
  int steps_held_ = 0;       ///< number of steps under held_
  bool shown_ = false;       ///< true if the camera has not lost the last image
  ddm_msgs::Torque answer_;  ///< answer to the last image so far; without values if there is none
  bool stopped_ = false;     ///< true after a refused torque, until the next reset
  std::uint32_t num_starts_ = 0;  ///< number of calls of bring_to_start
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
