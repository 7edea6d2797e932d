// mpc_node: answers each camera image with a torque.
// SPDX-License-Identifier: BSD-3-Clause
#include "mpc_node.h"

#include <ddm_common/image_codec.h>
#include <ddm_common/image_options.h>
#include <ddm_common/run_node.h>
#include <ddm_common/topic_peers.h>
#include <ddm_model/minimise.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/topics.h>

#include <algorithm>
#include <utility>

#include "plan_messages.h"

namespace ddm {
namespace {

constexpr int kQueue = 10;
const ros::WallDuration kPlanLogPeriod(5.0);
const ros::WallDuration kTick(0.1);  // also the period of feedback, to limit its load

ros::NodeHandle withQueue(ros::NodeHandle nh, ros::CallbackQueue* queue) {
  nh.setCallbackQueue(queue);
  return nh;
}

}  // namespace

MpcNode::MpcNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const MpcOptions& mpc,
                 const ControllerOptions& controller)
    : image_size_(image_size),
      mpc_(mpc),
      controller_(controller),
      applied_(nh),
      transport_(withQueue(nh, &image_queue_)),
      torque_pub_(nh.advertise<ddm_msgs::Torque>(topics::kTorque, kQueue)),
      plan_pub_(nh.advertise<ddm_msgs::Plan>(topics::kPlan, kQueue)),
      scalars_pub_(nh.advertise<ddm_msgs::PlanScalars>(topics::kPlanScalars, kQueue)),
      health_(nh, pnh),
      server_(nh, topics::kRunTrial, /*auto_start=*/false),
      prepare_(boost::make_shared<Callback>([this] { prepare(); })),
      finish_(boost::make_shared<Callback>([this] { onFinish(); })),
      image_spinner_(/*thread_count=*/1, &image_queue_) {
  server_.registerGoalCallback([this] { onGoal(); });
  server_.registerPreemptCallback([this] { onPreempt(); });
  model_sub_ = nh.subscribe(topics::kModel, 1, &MpcNode::onModel, this);
  goal_image_sub_ = nh.subscribe(topics::kGoalImage, 1, &MpcNode::onGoalImage, this);
  timer_ = nh.createSteadyTimer(kTick, [this](const ros::SteadyTimerEvent&) { onTick(); });
  image_sub_ = transport_.subscribe(
      topics::kImage, 1, &MpcNode::onImage, this,
      image_transport::TransportHints("raw", ros::TransportHints().tcpNoDelay()));
  image_spinner_.start();
  server_.start();  // last: a client that sees the action can use all topics
}

MpcNode::~MpcNode() {
  if (goal_ != nullptr) endTrial();  // otherwise the spinner waits for the end of the current plan
  image_spinner_.stop();             // no callback runs after this line
}

void MpcNode::onGoal() {
  // An image that arrives now is answered after the trial has begun.
  std::unique_lock<std::mutex> lock(mutex_);
  goal_ = server_.acceptNewGoal();
  health_.expect(ControlHealth::Expected::kModel);
  last_progress_ = ros::SteadyTime::now();
  beginIfReady(std::move(lock));
}

void MpcNode::onPreempt() {
  if (goal_ == nullptr) return;
  const ddm_msgs::RunTrialResult result = endTrial();
  // A new goal also sets the preempt flag and is accepted right after. It replaces this trial.
  if (server_.isActive() && !server_.isNewGoalAvailable()) server_.setPreempted(result);
}

void MpcNode::onModel(const ddm_msgs::ModelConstPtr& message) {
  const std::string bytes(message->data.begin(), message->data.end());
  try {
    model_ =
        std::make_shared<const Ddm>(deserialiseModel(bytes, "on topic " + model_sub_.getTopic()));
  } catch (const std::exception& e) {
    log_.error(std::string("model refused: ") + e.what());
    return;
  }
  model_id_ = modelId(bytes);
  health_.setModel(*message);
  log_.info("model " + model_id_ + " of trial " + std::to_string(message->trial) + " received");
  beginIfReady(std::unique_lock<std::mutex>(mutex_));
}

void MpcNode::onGoalImage(const sensor_msgs::ImageConstPtr& image) {
  try {
    decodeImage(*image, image_size_);
  } catch (const std::exception& e) {
    log_.error(std::string("goal image refused: ") + e.what());
    return;
  }
  std::unique_lock<std::mutex> lock(mutex_);
  goal_image_ = image;
  goal_changed_ = true;
  beginIfReady(std::move(lock));
}

/// Creates the trial once its model and its goal image have arrived, and queues its preparation for
/// the image thread.
/// @param lock  lock of mutex_
void MpcNode::beginIfReady(std::unique_lock<std::mutex> lock) {
  if (goal_ == nullptr || trial_ != nullptr || finished_) return;
  const std::string& model_id = goal_->model_id;
  if (!model_id.empty() && model_id != model_id_) return;
  const bool goal_image_is_there =
      goal_->goal.isZero() || (goal_image_ != nullptr && goal_image_->header.stamp == goal_->goal);
  if (!goal_image_is_there) return;
  try {
    trial_ = std::make_shared<TrialRun>(*goal_, model_id.empty() ? nullptr : model_, goal_image_,
                                        image_size_, mpc_, controller_);
  } catch (const std::exception& e) {
    lock.unlock();
    abort({std::string("trial refused: ") + e.what(), ""});
    return;
  }
  preparing_ = true;
  goal_changed_ = false;
  fed_back_ = 0;
  health_.expect(ControlHealth::Expected::kNothing);
  image_queue_.addCallback(prepare_);
}

/// Prepares the trial. In lock-step, the first image may have arrived before the goal, and the
/// simulator sends no second image before it gets a torque.
void MpcNode::prepare() {
  const std::shared_ptr<TrialRun> trial = preparedTrial();
  if (trial == nullptr || !trial->startIsGiven() || trial->lastAnswered()) return;
  const sensor_msgs::ImageConstPtr image = last_image_;
  if (image != nullptr) answer(*image);
}

/// Prepares the trial unless that is done. Releases the lock meanwhile, up to two seconds.
/// @return the current trial; null if there is none
std::shared_ptr<TrialRun> MpcNode::preparedTrial() {
  std::unique_lock<std::mutex> lock(mutex_);
  const std::shared_ptr<TrialRun> trial = trial_;
  if (trial == nullptr || !preparing_) return trial;
  lock.unlock();
  trial->prepare();
  lock.lock();
  if (trial_ != trial) return nullptr;  // the trial was cancelled meanwhile
  preparing_ = false;
  applied_.forget();
  last_progress_ = ros::SteadyTime::now();
  health_.expect(ControlHealth::Expected::kImage);
  return trial;
}

void MpcNode::onImage(const sensor_msgs::ImageConstPtr& image) {
  last_image_ = image;
  health_.countImage();
  answer(*image);
}

void MpcNode::answer(const sensor_msgs::Image& image) {
  const auto arrival = std::chrono::steady_clock::now();
  // A client whose goal is accepted may send an image before the queue calls prepare().
  const std::shared_ptr<TrialRun> trial = preparedTrial();
  std::unique_lock<std::mutex> lock(mutex_);
  if (trial == nullptr || trial->ended()) return;
  const sensor_msgs::ImageConstPtr new_goal = goal_changed_ ? goal_image_ : nullptr;
  goal_changed_ = false;
  deciding_since_ = ros::SteadyTime::now();
  lock.unlock();
  std::optional<Decision> decision;
  Trouble trouble;
  try {
    decision = decide(trial.get(), new_goal, image, arrival);
  } catch (const std::exception& e) {
    trouble = {std::string("image refused: ") + e.what(), image_sub_.getTopic()};
  }

  lock.lock();
  deciding_since_.reset();
  if (trial->ended()) return;  // the trial was cancelled meanwhile
  if (!trouble.text.empty()) {
    publishTorque(image.header.stamp, Eigen::VectorXd::Zero(controller_.torque_dim), false);
  } else if (decision) {
    last_progress_ = ros::SteadyTime::now();
    if (trial->result().num_steps == 0) predicted_.resize(0);
    trial->collect(image.header.stamp, *decision);
    publish(image.header, *decision);
    last_image_.reset();  // no later trial may begin with it, even if the clock is set back
    if (!trial->done()) return;
  } else {
    return;
  }
  trial->end();
  finished_ = trouble;
  ros::getGlobalCallbackQueue()->addCallback(finish_);
}

/// Decides the torque for an image. Needs no lock: a new goal may take as long to prepare as a
/// plan.
/// @param new_goal  goal image that arrived after the last image; null: none
/// @param arrival   arrival of the image, where mpc/time_budget begins
/// @return          empty if the image is not the next one of the trial
/// @throws std::invalid_argument if the image cannot be answered
std::optional<Decision> MpcNode::decide(TrialRun* trial, const sensor_msgs::ImageConstPtr& new_goal,
                                        const sensor_msgs::Image& image,
                                        std::chrono::steady_clock::time_point arrival) {
  if (image_sub_.getNumPublishers() > 1) {
    throw std::invalid_argument("only one node may publish images: stop the others");
  }
  if (new_goal != nullptr) trial->setGoal(*new_goal);
  if (const std::optional<ros::Time> last = trial->lastAnswered()) {
    const ddm_msgs::TorqueConstPtr applied = applied_.after(*last);
    if (applied != nullptr) trial->takeApplied(*applied);
  }
  return trial->decide(image, arrival);
}

void MpcNode::publish(const std_msgs::Header& header, const Decision& decision) {
  publishTorque(header.stamp, decision.torque, decision.exploratory);
  const Eigen::VectorXd predicted = std::exchange(predicted_, Eigen::VectorXd());
  if (!decision.plan) return;
  const Plan& plan = *decision.plan;
  health_.countPlan(plan);
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (plan.status == PlanStatus::kFailed && now - last_plan_log_ >= kPlanLogPeriod) {
    last_plan_log_ = now;
    log_.warn("plan failed, the torque is 0: " + plan.message);
  }
  plan_pub_.publish(planMessage(header.stamp, plan));
  scalars_pub_.publish(scalarsMessage(header.stamp, plan, decision.goal_distance, predicted));
  if (plan.status != PlanStatus::kFailed) predicted_ = plan.features.col(1);
}

void MpcNode::publishTorque(const ros::Time& stamp, const Eigen::VectorXd& torque,
                            bool exploratory) {
  ddm_msgs::Torque message;
  message.header.stamp = stamp;
  message.torque = flat(torque);
  message.exploratory = exploratory;
  torque_pub_.publish(message);
  health_.countTorque();
}

/// Reports the end of a trial that the image thread has ended.
void MpcNode::onFinish() {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!finished_) return;  // the trial was cancelled before this call
  const Trouble trouble = *finished_;
  lock.unlock();
  if (!trouble.text.empty()) return abort(trouble);
  const ddm_msgs::RunTrialGoalConstPtr goal = goal_;
  const ddm_msgs::RunTrialResult result = endTrial();
  log_.info(textOf("trial ", goal->trial, goal->evaluation != 0 ? " (evaluation)" : "", ": ",
                   result.num_steps, " torques, ", result.num_exploratory, " exploratory, ",
                   result.num_failed_plans, " failed plans, ", result.num_cut_plans, " cut short"));
  server_.setSucceeded(result);
}

void MpcNode::onTick() {
  if (goal_ == nullptr) return;
  ddm_msgs::RunTrialFeedback feedback;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (trial_ != nullptr) feedback.step = trial_->result().num_steps;
  }
  if (feedback.step != fed_back_) server_.publishFeedback(feedback);
  fed_back_ = feedback.step;
  const std::optional<Trouble> silence = describeSilence();
  if (silence) abort(*silence);
}

/// @return what has been missing for longer than controller/timeout; empty if nothing is missing
std::optional<MpcNode::Trouble> MpcNode::describeSilence() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (finished_ || preparing_) return std::nullopt;
  const ros::SteadyTime since = std::max(last_progress_, deciding_since_.value_or(last_progress_));
  if ((ros::SteadyTime::now() - since).toSec() <= controller_.timeout) return std::nullopt;
  const std::string limit = textOf(" within ", controller_.timeout, " s");
  if (trial_ != nullptr) {
    const auto num_steps = trial_->result().num_steps;
    if (deciding_since_) {
      return Trouble{textOf("no plan for step ", num_steps + 1, limit, ": set mpc/time_budget"),
                     ""};
    }
    return Trouble{textOf("no image after step ", num_steps, limit), image_sub_.getTopic()};
  }
  if (goal_->model_id.empty() || goal_->model_id == model_id_) {
    return Trouble{"the goal image of the trial did not come" + limit, goal_image_sub_.getTopic()};
  }
  return Trouble{"model " + goal_->model_id + " did not come" + limit, model_sub_.getTopic()};
}

/// Ends the trial and the search of its running plan.
ddm_msgs::RunTrialResult MpcNode::endTrial() {
  goal_.reset();
  const std::lock_guard<std::mutex> lock(mutex_);
  health_.expect(ControlHealth::Expected::kNothing);
  ddm_msgs::RunTrialResult result;
  if (trial_ != nullptr) {
    result = trial_->result();
    trial_->end();
  }
  trial_.reset();
  preparing_ = false;
  finished_.reset();
  return result;
}

/// Ends the trial before it asks the ROS master for publishers, since the master may answer late.
void MpcNode::abort(const Trouble& trouble) {
  const ddm_msgs::RunTrialResult result = endTrial();
  std::string reason = trouble.text;
  if (trouble.topic == image_sub_.getTopic()) {
    reason += ": " + describeImagePublishers(trouble.topic, "camera/image_raw:=");
  } else if (!trouble.topic.empty()) {
    reason += ": " + describePublishers(trouble.topic);
  }
  log_.error(reason);
  server_.setAborted(result, reason);
}

}  // namespace ddm

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  return ddm::runNode("mpc_node", argc, argv, [](auto nh, auto pnh, ddm::ParamReader* params) {
    params->ignore("image_transport");    // image_transport reads it
    params->ignore("diagnostic_period");  // diagnostic_updater reads it
    const auto image = params->read<ddm::ImageOptions>("image");
    const auto mpc = params->read<ddm::MpcOptions>("mpc");
    const auto controller = params->read<ddm::ControllerOptions>("controller");
    params->requireValid();
    ROS_INFO_STREAM("mpc_node runs with\n" << ddm::toYaml(mpc) << "\n" << ddm::toYaml(controller));
    ddm::MpcNode node(nh, pnh, image.size, mpc, controller);
    ros::spin();
  });
}
