// The plant behind topics: what lock-step and real time have in common.
// SPDX-License-Identifier: BSD-3-Clause
#include "sim_node.h"

#include <algorithm>
#include <random>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ddm_msgs/topics.h"
#include "ddm_node/topic_peers.h"
#include "ddm_sim/few_numbers.h"

namespace ddm {
namespace {

constexpr int kQueueSize = 10;
constexpr int kAppliedQueueSize = 1000;  // a recorder that is slow must not lose one
constexpr double kRubbish = 1000.0;      // times max_torque: no command, but an error

Eigen::VectorXd toEigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

SimNode::SimNode(ros::NodeHandle nh, std::unique_ptr<Plant> plant, const CameraOptions& camera,
                 bool clock)
    : plant_(std::move(plant)),
      camera_(camera),
      publisher_(nh, *plant_, clock),
      applied_(Eigen::VectorXd::Zero(plant_->torqueDim())),
      applied_pub_(nh.advertise<ddm_msgs::Torque>(topics::kAppliedTorque, kAppliedQueueSize)) {
  torque_sub_ = nh.subscribe(topics::kTorque, kQueueSize, &SimNode::onTorque, this,
                             ros::TransportHints().tcpNoDelay());
  // Last: whoever sees the service finds everything else in place.
  reset_server_ = nh.advertiseService(topics::kReset, &SimNode::onReset, this);
}

bool SimNode::advance(const Eigen::VectorXd& torque) {
  try {
    applied_ = plant_->step(torque);
    return true;
  } catch (const std::range_error& e) {
    ROS_ERROR_STREAM("the trial ends, a reset starts another: " << e.what());
    return false;
  }
}

bool SimNode::publishFrame(const ros::Time& stamp) {
  const auto photograph = camera_.photograph(*plant_);
  if (photograph) publisher_.publishFrame(applied_, *photograph, stamp);
  return photograph.has_value();
}

void SimNode::publishApplied(ddm_msgs::Torque answer) const {
  const double limit = plant_->maxTorque();
  for (double& value : answer.torque) value = std::max(-limit, std::min(limit, value));
  applied_pub_.publish(answer);
}

void SimNode::publishGoal(const ros::Time& stamp) const {
  publisher_.publishGoal(camera_.photographGoal(*plant_), stamp);
}

bool SimNode::onReset(ddm_msgs::Reset::Request& request, ddm_msgs::Reset::Response& response) {
  std::mt19937_64 engine = startStream(request.seed, request.trial, request.evaluation);
  try {
    plant_->setState(request.start.empty() ? plant_->drawStart(engine) : toEigen(request.start));
  } catch (const std::invalid_argument& e) {
    response.success = false;
    response.message = std::string("field `start` of the request: ") + e.what();
    ROS_WARN_STREAM("reset refused, nothing has changed: " << response.message);
    return true;
  }
  applied_.setZero();
  camera_.begin(request.seed, request.trial, request.evaluation);
  response.start = beginTrial(request);
  response.success = true;
  return true;
}

void SimNode::onTorque(const ros::MessageEvent<ddm_msgs::Torque const>& event) {
  const ddm_msgs::Torque& message = *event.getMessage();
  const Eigen::VectorXd torque = toEigen(message.torque);
  const std::string rule = brokenRule(torque);
  if (rule.empty()) {
    takeTorque(message, torque, event.getPublisherName());
    return;
  }
  std::ostringstream reason;
  reason << "torque refused: " << event.getPublisherName() << " published " << fewNumbers(torque)
         << " on " << torqueTopic() << ", " << rule;
  ROS_ERROR_STREAM(reason.str());
  torqueRefused(message.header.stamp, reason.str());
}

/// @return empty if the motor may follow the torque
std::string SimNode::brokenRule(const Eigen::VectorXd& torque) const {
  if (torque_sub_.getNumPublishers() > 1) {
    return "only one node may drive the motor: stop the others, " +
           describePublishers(torqueTopic());
  }
  std::ostringstream rule;
  const double limit = kRubbish * plant_->maxTorque();
  if (torque.size() != plant_->torqueDim() || !torque.allFinite()) {
    rule << "it must be " << plant_->torqueDim() << " finite number(s):";
    for (const std::string& name : plant_->torqueNames()) rule << ' ' << name;
  } else if (torque.cwiseAbs().maxCoeff() > limit) {
    rule << "it must lie within +-" << limit << ", which is " << kRubbish
         << " times what the motor can do: check the units";
  }
  return rule.str();
}

}  // namespace ddm
