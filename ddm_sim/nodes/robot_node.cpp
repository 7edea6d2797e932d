// robot_node: camera, torques and motors.
// SPDX-License-Identifier: BSD-3-Clause
#include "robot_node.h"

#include <actionlib_msgs/GoalID.h>
#include <ddm_common/image_codec.h>
#include <ddm_common/image_options.h>
#include <ddm_common/run_node.h>
#include <ddm_msgs/topics.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/UInt32.h>

#include <algorithm>
#include <stdexcept>

namespace ddm {
namespace {

constexpr int kQueue = 10;
constexpr int kRecordedQueue = 1000;  // long enough that a slow recorder loses no message
// a camera without an image for longer is not available
constexpr std::chrono::seconds kFreshCamera(1);
// Period at which efforts are sent and time limits are checked.
const ros::WallDuration kEffortPeriod(0.01);
const ros::WallDuration kDiagnosisPeriod(1.0);
const ros::WallDuration kImageLogPeriod(5.0);

}  // namespace

RobotNode::RobotNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size,
                     const RobotOptions& options)
    : image_size_(image_size),
      options_(options),
      reset_service_(options.reset_service.empty() ? "" : nh.resolveName(options.reset_service)),
      gate_(options),
      stamps_(options.dt),
      picker_(options.dt),
      transport_(nh),
      image_pub_(transport_.advertise(topics::kImage, kRecordedQueue)),
      goal_pub_(nh.advertise<sensor_msgs::Image>(topics::kGoalImage, 1, /*latch=*/true)),
      effort_pub_(
          options.numMotors() == 1
              ? nh.advertise<std_msgs::Float64>(topics::kEffortCommand, kQueue)
              : nh.advertise<std_msgs::Float64MultiArray>(topics::kGroupEffortCommand, kQueue)),
      applied_pub_(nh.advertise<ddm_msgs::Torque>(topics::kAppliedTorque, kRecordedQueue)),
      latency_pub_(nh.advertise<std_msgs::Float64>(topics::kLatency, kQueue)),
      misses_pub_(nh.advertise<std_msgs::UInt32>(topics::kDeadlineMisses, 1, /*latch=*/true)),
      cancel_pub_(
          nh.advertise<actionlib_msgs::GoalID>(std::string(topics::kRunTrial) + "/cancel", 1)),
      enabled_pub_(nh.advertise<std_msgs::Bool>(topics::kMotorsEnabled, 1, /*latch=*/true)),
      updater_(nh, pnh) {
  if (nh.resolveName(topics::kCamera) == nh.resolveName(topics::kImage)) {
    throw std::invalid_argument(
        "the camera's topic is " + nh.resolveName(topics::kImage) +
        ", on which this node publishes: rename the driver's, or start all of this in a namespace, "
        "ROS_NAMESPACE=ddm roslaunch ...");
  }
  loadGoal();
  enabled_pub_.publish(std_msgs::Bool());
  updater_.setHardwareID("none");
  updater_.add("motor and camera", this, &RobotNode::diagnose);
  torque_sub_ = nh.subscribe(topics::kTorque, kQueue, &RobotNode::onTorque, this,
                             ros::TransportHints().tcpNoDelay());
  if (JointLimits(options).given()) {
    joints_sub_ = nh.subscribe(topics::kJointStates, kQueue, &RobotNode::onJointStates, this,
                               ros::TransportHints().tcpNoDelay());
  } else {
    log_.warn(
        "positions and speeds are not guarded: robot/position_limits and robot/speed_limit are "
        "empty");
  }
  trial_end_sub_ =
      nh.subscribe(std::string(topics::kRunTrial) + "/result", 1, &RobotNode::onTrialEnd, this);
  camera_sub_ = transport_.subscribe(
      topics::kCamera, 1, &RobotNode::onImage, this,
      image_transport::TransportHints("raw", ros::TransportHints().tcpNoDelay(), pnh));
  timer_ = nh.createSteadyTimer(kEffortPeriod, &RobotNode::onTick, this);
  diagnosis_timer_ = nh.createSteadyTimer(kDiagnosisPeriod, [this](const ros::SteadyTimerEvent&) {
    guarded([this] { updater_.force_update(); });  // update() uses a clock that can be set
  });
  enable_server_ = nh.advertiseService(topics::kEnable, &RobotNode::onEnable, this);
  take_goal_server_ = nh.advertiseService(topics::kTakeGoal, &RobotNode::onTakeGoal, this);
  reset_done_server_ = nh.advertiseService(topics::kResetDone, &RobotNode::onResetDone, this);
  // The service comes last, so that all topics exist when another node finds it.
  reset_server_ = nh.advertiseService(topics::kReset, &RobotNode::onReset, this);
}

void RobotNode::stopMotors(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  stop(reason);
}

void RobotNode::stop(const std::string& reason) {
  gate_.stop(reason);
  publishEffort();
}

/// Runs a callback and stops the motors if it throws. roscpp ends a process in which a callback
/// throws, and the motors would keep their last torque.
template <class Work>
void RobotNode::guarded(const Work& work) {
  try {
    work();
  } catch (const std::exception& e) {
    stopMotors(std::string("this node failed: ") + e.what());
  }
}

/// Converts a camera image to the image for the controller.
/// @throws std::invalid_argument if the image cannot be used
sensor_msgs::Image RobotNode::shown(const sensor_msgs::Image& image) const {
  const ImageCrop crop{options_.crop[0], options_.crop[1], options_.crop[2], options_.crop[3]};
  return encodeImage(decodeImage(image, image_size_, crop), image_size_, image.header.stamp,
                     image.header.frame_id);
}

bool RobotNode::seesCamera() const {
  return image_ != nullptr && steadyNow() - image_arrival_ <= kFreshCamera;
}

void RobotNode::onImage(const sensor_msgs::ImageConstPtr& image) {
  guarded([&] {
    const Stamp stamp = toStamp(image->header.stamp);
    const auto num_cameras = camera_sub_.getNumPublishers();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      image_ = image;
      image_arrival_ = steadyNow();
      image_arrival_clock_ = toStamp(ros::Time::now());
      std::string problem = num_cameras > 1 ? std::to_string(num_cameras) +
                                                  " nodes publish images there: end all but one"
                                            : formatProblem(*image);
      if (problem.empty()) problem = stamps_.take(image_arrival_, image_arrival_clock_, stamp);
      if (!problem.empty()) return refuseImage(problem);
      if (!picker_.pick(stamp)) return;
    }
    sensor_msgs::Image out;
    std::string problem;
    try {
      out = shown(*image);  // without the lock, because the conversion takes time
    } catch (const std::exception& e) {
      problem = e.what();
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!problem.empty()) return refuseImage(problem);
      image_problem_.clear();
      settle(true);
      // Before publication, so that the answer cannot arrive earlier.
      gate_.showImage(stamps_.taken(), stamp);
    }
    image_pub_.publish(out);
  });
}

/// Describes a change of size or encoding of the images, which would make the crop show another
/// part of the scene; empty if nothing has changed.
std::string RobotNode::formatProblem(const sensor_msgs::Image& image) const {
  if (camera_format_.empty() || formatOf(image) == camera_format_) return "";
  return "the images have changed from " + camera_format_ + " to " + formatOf(image) +
         ", so that the crop shows something else: set the camera back, or start again with "
         "another goal and another folder";
}

/// Logs the problem of the newest image, at most once every kImageLogPeriod.
void RobotNode::refuseImage(const std::string& problem) {
  image_problem_ = problem;
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (now - last_image_log_ < kImageLogPeriod) return;
  last_image_log_ = now;
  log_.warn("image of " + camera_sub_.getTopic() + ": " + problem);
}

void RobotNode::onTorque(const ros::MessageEvent<const ddm_msgs::Torque>& event) {
  guarded([&] {
    const ddm_msgs::Torque& torque = *event.getConstMessage();
    const Stamp arrival = toStamp(ros::Time::now());
    const Stamp stamp = toStamp(torque.header.stamp);
    const std::lock_guard<std::mutex> lock(mutex_);
    controller_watch_.hear(event.getPublisherName());
    lookAtPeers();
    const bool acts = gate_.takeTorque(steadyNow(), stamp, torque.torque);
    publishEffort();
    if (acts) {
      if (camera_format_.empty() && image_ != nullptr) camera_format_ = formatOf(*image_);
      settle(true);
      acting_ = torque;
      acting_.torque = gate_.target();
    }
    if (!gate_.armed()) cancelTrial();  // because the episode has begun while the motors are off
    std_msgs::Float64 latency;
    latency.data = toSeconds(arrival - stamp);
    latency_pub_.publish(latency);
    worst_latency_ = std::max(worst_latency_, latency.data);
  });
}

void RobotNode::onJointStates(const ros::MessageEvent<const sensor_msgs::JointState>& event) {
  guarded([&] {
    const sensor_msgs::JointState& joints = *event.getConstMessage();
    JointReport report;
    report.arrival = steadyNow();
    report.clock = toStamp(ros::Time::now());
    report.stamp = toStamp(joints.header.stamp);
    report.reporter = event.getPublisherName();
    report.names = joints.name;
    report.positions = joints.position;
    report.velocities = joints.velocity;
    const std::lock_guard<std::mutex> lock(mutex_);
    gate_.takeJoints(report);
    if (was_armed_ && !gate_.armed()) publishEffort();  // only after a stop, not at each report
  });
}

void RobotNode::onTrialEnd(const ddm_msgs::RunTrialActionResultConstPtr& /*result*/) {
  guarded([this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    settle(true);
    gate_.endTrial();
    publishEffort();
  });
}

void RobotNode::onTick(const ros::SteadyTimerEvent& /*event*/) {
  guarded([this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    lookAtPeers();
    publishEffort();
  });
}

void RobotNode::lookAtPeers() {
  auto num_publishers = static_cast<int>(torque_sub_.getNumPublishers());
  if (controller_watch_.died()) num_publishers = 0;
  gate_.setPublishers(num_publishers);
  gate_.setListeners(static_cast<int>(effort_pub_.getNumSubscribers()));
}

/// Publishes the effort and everything that depends on the state of the gate. Call this function
/// after each change.
void RobotNode::publishEffort() {
  const std::vector<double>& effort = gate_.effort(steadyNow());
  // Because a stop takes the motors from the reset service.
  if (!gate_.armed()) routine_moves_ = false;
  if (!routine_moves_) sendEffort(effort);
  if (gate_.state() != TorqueGate::State::kFollowing) settle(gate_.heldForAStep());
  for (const Stamp& stamp : gate_.takeUnanswered()) {
    ddm_msgs::Torque nothing;
    nothing.header.stamp.fromNSec(static_cast<std::uint64_t>(stamp.count()));
    applied_pub_.publish(nothing);
  }
  reportState();
}

/// Publishes the torques of all motors for the effort controllers of ros_control: as
/// std_msgs/Float64 on `effort_command` for one motor, as std_msgs/Float64MultiArray on
/// `group_effort_command` for several motors.
/// @param effort  one value per motor [N m]                                         [numMotors()]
void RobotNode::sendEffort(const std::vector<double>& effort) {
  if (options_.numMotors() == 1) {
    std_msgs::Float64 message;
    message.data = effort.front();
    effort_pub_.publish(message);
  } else {
    std_msgs::Float64MultiArray message;
    message.data = effort;
    effort_pub_.publish(message);
  }
}

/// Publishes the torque that acted after the last answered image, at the end of its step.
/// @param acted  whether the torque acted until the end of the step. If not, an empty torque is
///         published, and the sample is not used for learning
void RobotNode::settle(bool acted) {
  if (acting_.torque.empty()) return;
  if (!acted) acting_.torque.clear();
  applied_pub_.publish(acting_);
  acting_.torque.clear();
}

void RobotNode::reportState() {
  if (gate_.numMisses() != last_misses_) {
    last_misses_ = gate_.numMisses();
    std_msgs::UInt32 misses;
    misses.data = static_cast<std::uint32_t>(last_misses_);
    misses_pub_.publish(misses);
  }
  if (was_armed_ && !gate_.armed()) cancelTrial();
  if (was_armed_ != gate_.armed()) {
    std_msgs::Bool enabled;
    enabled.data = gate_.armed();
    enabled_pub_.publish(enabled);
  }
  was_armed_ = gate_.armed();
  const std::string frozen = gate_.frozenJoint();
  if (last_frozen_.empty() && !frozen.empty()) log_.warn(frozen);
  last_frozen_ = frozen;
  const std::string state = gate_.describe();
  if (state == last_state_) return;
  last_state_ = state;
  if (gate_.isFine()) {
    log_.info(state);
  } else {
    log_.warn(state);
  }
}

/// Cancels the current episode or the one about to begin, if there is one.
void RobotNode::cancelTrial() {
  cancel_pub_.publish(actionlib_msgs::GoalID());  // without an id: cancels all goals
}

void RobotNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  status.summary(gate_.isFine() ? diagnostic_msgs::DiagnosticStatus::OK
                                : diagnostic_msgs::DiagnosticStatus::WARN,
                 gate_.describe());
  if (!image_problem_.empty()) {
    status.summary(diagnostic_msgs::DiagnosticStatus::ERROR, image_problem_);
  }
  const std::string frozen = gate_.frozenJoint();
  if (!frozen.empty()) status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, frozen);
  status.add("torques in time", gate_.numAnswers());
  status.add("deadlines missed", gate_.numMisses());
  status.add("worst latency since the last status [s]", worst_latency_);
  status.add("time between images [s]", picker_.step());
  status.add("images refused for their stamps", stamps_.numRefused());
  worst_latency_ = 0.0;
}

}  // namespace ddm

int main(int argc, char** argv) {
  const auto run = [](const auto& nh, const auto& pnh, ddm::ParamReader* params) {
    params->ignore("image_transport");    // image_transport itself reads it
    params->ignore("diagnostic_period");  // diagnostic_updater itself reads it
    const auto image = params->read<ddm::ImageOptions>("image");
    const auto robot = params->read<ddm::RobotOptions>("robot");
    params->requireValid();
    ROS_INFO_STREAM("robot_node runs with\n" << ddm::toYaml(robot));
    ddm::RobotNode node(nh, pnh, image.size, robot);
    ros::AsyncSpinner spinner(4);  // one of the threads may be blocked in a reset
    spinner.start();
    ddm::runUntilEnd([&node] { node.stopMotors("this node ends"); });
  };
  return ddm::runNode("robot_node", argc, argv, run, ddm::Ending::kByLastMessage);
}
