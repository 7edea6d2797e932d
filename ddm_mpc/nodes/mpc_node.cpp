// mpc_node: answers camera images with torques.
// SPDX-License-Identifier: BSD-3-Clause
#include "mpc_node.h"

#include <ddm_model/model_file.h>
#include <ddm_msgs/Plan.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topic_peers.h>
#include <ddm_msgs/topics.h>

#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr int kQueue = 10;
const ros::WallDuration kTick(0.1);
const ros::WallDuration kFeedbackPeriod(0.1);  // for people; for each frame it would be a load

std::vector<double> flat(const Eigen::MatrixXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

}  // namespace

MpcNode::MpcNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const MpcOptions& mpc,
                 const ControllerOptions& controller)
    : image_size_(image_size),
      mpc_(mpc),
      controller_(controller),
      transport_(nh),
      torque_pub_(nh.advertise<ddm_msgs::Torque>(topics::kTorque, kQueue)),
      effort_(nh, controller.torque_dim),
      plan_pub_(nh.advertise<ddm_msgs::Plan>(topics::kPlan, kQueue)),
      scalars_pub_(nh.advertise<ddm_msgs::PlanScalars>(topics::kPlanScalars, kQueue)),
      live_(ros::NodeHandle(pnh, "mpc"), mpc, [this](const MpcOptions& turned) { onTurn(turned); }),
      health_(nh, pnh),
      server_(nh, topics::kRunTrial, /*auto_start=*/false) {
  server_.registerGoalCallback([this] { onGoal(); });
  server_.registerPreemptCallback([this] { onPreempt(); });
  model_sub_ = nh.subscribe(topics::kModel, 1, &MpcNode::onModel, this);
  timer_ = nh.createWallTimer(kTick, [this](const ros::WallTimerEvent&) { onTick(); });
  image_sub_ = transport_.subscribe(
      topics::kImage, 1, &MpcNode::onImage, this,
      image_transport::TransportHints("raw", ros::TransportHints().tcpNoDelay()));
  server_.start();  // last: whoever sees the action finds everything else in place
}

void MpcNode::onGoal() {
  goal_ = server_.acceptNewGoal();
  trial_.reset();
  health_.expect(ControlHealth::Expected::kModel);
  last_progress_ = ros::WallTime::now();
  beginIfReady();
}

void MpcNode::onPreempt() {
  if (goal_ == nullptr) return;
  const ddm_msgs::RunTrialResult result = endTrial();
  // A new goal sets this flag too, and is accepted right after; then there is nothing left to end.
  if (server_.isActive() && !server_.isNewGoalAvailable()) server_.setPreempted(result);
}

void MpcNode::onModel(const ddm_msgs::ModelConstPtr& message) {
  const std::string bytes(message->data.begin(), message->data.end());
  try {
    model_ =
        std::make_shared<const Ddm>(deserialiseModel(bytes, "on topic " + model_sub_.getTopic()));
    model_id_ = modelId(bytes);
    health_.takeModel(*message);
    ROS_INFO("model %s of trial %u received", model_id_.c_str(), message->trial);
  } catch (const std::exception& e) {
    ROS_ERROR_STREAM("model refused: " << e.what());
    return;
  }
  beginIfReady();
}

/// Starts the trial once its model is there.
void MpcNode::beginIfReady() {
  if (goal_ == nullptr || trial_ != nullptr) return;
  if (!goal_->model_id.empty() && goal_->model_id != model_id_) return;
  try {
    trial_ = std::make_unique<TrialRun>(*goal_, goal_->model_id.empty() ? nullptr : model_,
                                        image_size_, mpc_, controller_);
    trial_->turn(mpc_, turned_epsilon_);
  } catch (const std::exception& e) {
    abort(std::string("trial refused: ") + e.what());
    return;
  }
  last_progress_ = ros::WallTime::now();
  health_.expect(ControlHealth::Expected::kImage);
  // In lock-step the first image may have come before the goal; there will be no second one.
  if (last_image_ != nullptr && !goal_->start.isZero()) answer(*last_image_);
}

void MpcNode::onTurn(const MpcOptions& mpc) {
  if (mpc.epsilon != mpc_.epsilon) turned_epsilon_ = mpc.epsilon;
  mpc_ = mpc;
  if (trial_ != nullptr) trial_->turn(mpc_, turned_epsilon_);
}

void MpcNode::onImage(const sensor_msgs::ImageConstPtr& image) {
  last_image_ = image;
  health_.countImage();
  if (trial_ != nullptr) answer(*image);
}

void MpcNode::answer(const sensor_msgs::Image& image) {
  try {
    if (image_sub_.getNumPublishers() > 1) {
      throw std::runtime_error("only one camera may be looked through: stop the others, " +
                               describePublishers(image_sub_.getTopic()));
    }
    const std::optional<Decision> decision = trial_->answer(image);
    if (!decision) return;
    last_progress_ = ros::WallTime::now();
    publish(image.header, *decision);
  } catch (const std::exception& e) {
    publishTorque(image.header.stamp, Eigen::VectorXd::Zero(controller_.torque_dim), false);
    abort(std::string("image refused: ") + e.what());
    return;
  }
  if (last_progress_ - last_feedback_ > kFeedbackPeriod) {
    last_feedback_ = last_progress_;
    ddm_msgs::RunTrialFeedback feedback;
    feedback.step = trial_->result().num_steps;
    server_.publishFeedback(feedback);
  }
  if (!trial_->done()) return;
  const ddm_msgs::RunTrialResult& so_far = trial_->result();
  ROS_INFO("trial %u%s: %u torques, %u exploratory, %u failed plans", goal_->trial,
           goal_->evaluation != 0 ? " (evaluation)" : "", so_far.num_steps, so_far.num_exploratory,
           so_far.num_failed_plans);
  server_.setSucceeded(endTrial());
}

void MpcNode::publish(const std_msgs::Header& header, const Decision& decision) {
  publishTorque(header.stamp, decision.torque, decision.exploratory);
  if (decision.plan) publishPlan(header.stamp, *decision.plan);
  if (decision.plan && scalars_pub_.getNumSubscribers() > 0) {
    scalars_pub_.publish(scalars_.of(header.stamp, *decision.plan));
  } else {
    scalars_.forget();
  }
}

void MpcNode::publishTorque(const ros::Time& stamp, const Eigen::VectorXd& torque,
                            bool exploratory) {
  ddm_msgs::Torque message;
  message.header.stamp = stamp;
  message.torque = flat(torque);
  message.exploratory = exploratory;
  torque_pub_.publish(message);
  health_.countTorque();
  effort_.publish(torque);
}

void MpcNode::publishPlan(const ros::Time& stamp, const Plan& plan) {
  health_.countPlan(plan);
  if (plan.status == PlanStatus::kFailed) {
    ROS_WARN_STREAM_THROTTLE(5.0, "plan failed, the torque is 0: " << plan.message);
  }
  ddm_msgs::Plan message;
  message.header.stamp = stamp;
  message.horizon = static_cast<std::uint32_t>(plan.torques.cols());
  message.torque = flat(plan.torques);
  message.feature = flat(plan.features);
  message.goal_feature = flat(plan.goal_feature);
  message.cost = plan.cost;
  message.iterations = plan.iterations;
  message.evaluations = plan.evaluations;
  message.status = plan.status == PlanStatus::kConverged        ? ddm_msgs::Plan::CONVERGED
                   : plan.status == PlanStatus::kIterationLimit ? ddm_msgs::Plan::ITERATION_LIMIT
                                                                : ddm_msgs::Plan::FAILED;
  message.message = plan.message;
  message.solve_time = plan.solve_time;
  plan_pub_.publish(message);
}

void MpcNode::onTick() {
  if (goal_ == nullptr) return;
  const double silence = (ros::WallTime::now() - last_progress_).toSec();
  if (silence <= controller_.timeout) return;
  std::ostringstream reason;
  if (trial_ == nullptr) {
    reason << "model " << goal_->model_id << " did not come";
  } else {
    reason << "no image after step " << trial_->result().num_steps;
  }
  reason << " within " << controller_.timeout << " s: "
         << describePublishers(trial_ == nullptr ? model_sub_.getTopic() : image_sub_.getTopic());
  abort(reason.str());
}

/// However a trial ends, an effort controller must not go on with its last torque.
ddm_msgs::RunTrialResult MpcNode::endTrial() {
  const ddm_msgs::RunTrialResult result =
      trial_ != nullptr ? trial_->result() : ddm_msgs::RunTrialResult();
  goal_.reset();
  trial_.reset();
  scalars_.forget();
  health_.expect(ControlHealth::Expected::kNothing);
  effort_.publishZero();
  return result;
}

void MpcNode::abort(const std::string& reason) {
  ROS_ERROR_STREAM(reason);
  const ddm_msgs::RunTrialResult result = endTrial();
  server_.setAborted(result, reason);
}

}  // namespace ddm
