// The ROS interface of a simulated plant: the common part of lock-step and real time.
// SPDX-License-Identifier: BSD-3-Clause
#include "sim_node.h"

#include <ddm_plant_plugin/image_message.h>
#include <image_transport/image_transport.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <stdexcept>
#include <utility>

#include "ddm_common/topic_peers.h"
#include "ddm_msgs/topics.h"
#include "ddm_sim/plant.h"
#include "joint_state.h"

namespace ddm {
namespace {

constexpr int kQueueSize = 10;
constexpr int kLongQueueSize = 1000;  // long enough that a slow recorder loses no message
// Multiple of max_torque. A larger torque is an error of the sender and is refused.
constexpr double kRubbish = 1000.0;

Eigen::VectorXd toEigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

SimNode::SimNode(ros::NodeHandle nh, std::unique_ptr<Environment> environment)
    : environment_(std::move(environment)),
      optical_frame_(opticalFrame(plant().cameraModel())),
      goal_pub_(nh.advertise<sensor_msgs::Image>(topics::kGoalImage, 1, /*latch=*/true)),
      ground_truth_pub_(
          nh.advertise<sensor_msgs::JointState>(topics::kGroundTruth, kLongQueueSize)),
      applied_pub_(nh.advertise<ddm_msgs::Torque>(topics::kAppliedTorque, kLongQueueSize)),
      image_pub_(image_transport::ImageTransport(nh).advertise(topics::kImage, kLongQueueSize)),
      view_(nh, plant()) {
  torque_sub_ = nh.subscribe<ddm_msgs::Torque>(
      topics::kTorque, kQueueSize,
      boost::function<void(const ros::MessageEvent<const ddm_msgs::Torque>&)>(
          [this](const ros::MessageEvent<const ddm_msgs::Torque>& event) {
            handleTorque(*event.getMessage(), event.getPublisherName(), torque_sub_.getTopic());
          }),
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  // The service comes last, so that all topics exist when another node finds it.
  reset_server_ = nh.advertiseService(topics::kReset, &SimNode::onReset, this);
}

bool SimNode::advance(const Eigen::VectorXd& torque) {
  try {
    seen_ = environment_->step(torque);
    return true;
  } catch (const std::range_error& e) {
    ROS_ERROR_STREAM("the trial ends, a reset starts another: " << e.what());
    return false;
  }
}

bool SimNode::publishImage(const ros::Time& stamp) {
  if (!seen_) return false;
  image_pub_.publish(imageMessage(*seen_, stamp, optical_frame_));
  untold_.push_back(jointStateOf(plant(), environment_->applied()));
  untold_.back().header.stamp = stamp;
  view_.publish(*seen_, stamp);  // last, so that the view does not delay the controller
  return true;
}

void SimNode::publishGroundTruth() {
  for (const sensor_msgs::JointState& joints : untold_) ground_truth_pub_.publish(joints);
  untold_.clear();
}

void SimNode::publishApplied(ddm_msgs::Torque answer) const {
  for (std::size_t i = 0; i < answer.torque.size(); ++i) {
    const double bound = plant().info().max_torque[static_cast<Eigen::Index>(i)];
    answer.torque[i] = std::clamp(answer.torque[i], -bound, bound);
  }
  applied_pub_.publish(answer);
}

void SimNode::publishGoal(const ros::Time& stamp) {
  RenderedImage image = environment_->goalImage();
  if (image.bytes == goal_image_.bytes) return;
  goal_image_ = std::move(image);
  goal_stamp_ = stamp;
  goal_pub_.publish(imageMessage(goal_image_, stamp, optical_frame_));
}

bool SimNode::onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response) {
  std::optional<Eigen::VectorXd> start;
  if (!request.start.empty()) start = toEigen(request.start);
  try {
    seen_ = environment_->reset({request.seed, request.trial, request.evaluation != 0}, start);
    response.start = beginTrial(request);
    response.goal = goal_stamp_;
    response.success = true;
  } catch (const std::invalid_argument& e) {
    response.message = e.what();
    ROS_WARN_STREAM("reset refused, nothing has changed: " << response.message);
  } catch (const std::exception& e) {  // such as a rendering error
    response.message =
        "the plant failed in the reset, no trial has begun: " + std::string(e.what());
    ROS_ERROR_STREAM(response.message);
  }
  return true;
}

void SimNode::handleTorque(const ddm_msgs::Torque& message, const std::string& publisher,
                           const std::string& topic) {
  const Eigen::VectorXd torque = toEigen(message.torque);
  const std::string rule = brokenRule(torque);
  if (rule.empty()) return takeTorque(message, torque, publisher);
  torqueRefused(message.header.stamp, "torque refused: " + publisher + " published " +
                                          fewNumbers(torque) + " on " + topic + ", " + rule);
}

/// @return the rule that the torque breaks; empty if the torque is valid
std::string SimNode::brokenRule(const Eigen::VectorXd& torque) const {
  if (torque_sub_.getNumPublishers() > 1) {
    return "only one node may drive the motor: stop the others, " +
           describePublishers(torque_sub_.getTopic());
  }
  const PlantInfo& info = plant().info();
  if (torque.size() != info.torqueDim() || !torque.allFinite()) {
    return "it must be " + std::to_string(info.torqueDim()) +
           " finite number(s): " + boost::algorithm::join(info.torque_names, " ");
  }
  if ((torque.cwiseAbs() - kRubbish * info.max_torque).maxCoeff() > 0.0) {
    return "it must lie within +-" + fewNumbers(kRubbish * info.max_torque) +
           ", which is 1000 times what the motor can do: check the units";
  }
  return "";
}

}  // namespace ddm
