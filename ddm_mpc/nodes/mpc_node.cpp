// mpc_node: answers camera images with torques.
// SPDX-License-Identifier: BSD-3-Clause
#include "mpc_node.h"

#include <ddm_images/image_codec.h>
#include <ddm_model/model_file.h>
#include <ddm_model/solver_log.h>
#include <ddm_msgs/Plan.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ddm_node/run_node.h>
#include <ddm_node/topic_peers.h>
#include <ddm_params/image_options.h>
#include <ros/callback_queue.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr int kQueue = 10;
constexpr std::chrono::milliseconds kAppliedLimit(20);
constexpr std::size_t kMaxApplied = 100;
const ros::WallDuration kPlanLogPeriod(5.0);
const ros::WallDuration kTick(0.1);  // of feedback too: for each frame it would be a load

ros::NodeHandle withQueue(ros::NodeHandle nh, ros::CallbackQueue* queue) {
  nh.setCallbackQueue(queue);
  return nh;
}

std::vector<double> flat(const Eigen::MatrixXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

std::uint8_t statusOf(const Plan& plan) {
  switch (plan.status) {
    case PlanStatus::kConverged:
      return ddm_msgs::Plan::CONVERGED;
    case PlanStatus::kIterationLimit:
      return ddm_msgs::Plan::ITERATION_LIMIT;
    case PlanStatus::kTimeLimit:
      return ddm_msgs::Plan::TIME_LIMIT;
    case PlanStatus::kFailed:
      break;
  }
  return ddm_msgs::Plan::FAILED;
}

}  // namespace

MpcNode::MpcNode(ros::NodeHandle nh, ros::NodeHandle pnh, int image_size, const MpcOptions& mpc,
                 const ControllerOptions& controller)
    : image_size_(image_size),
      controller_(controller),
      mpc_(mpc),
      transport_(withQueue(nh, &image_queue_)),
      torque_pub_(nh.advertise<ddm_msgs::Torque>(topics::kTorque, kQueue)),
      plan_pub_(nh.advertise<ddm_msgs::Plan>(topics::kPlan, kQueue)),
      scalars_pub_(nh.advertise<ddm_msgs::PlanScalars>(topics::kPlanScalars, kQueue)),
      live_(withQueue(ros::NodeHandle(pnh, "mpc"), &options_queue_), mpc,
            [this](const MpcOptions& turned) { onTurn(turned); }),
      health_(nh, pnh),
      server_(nh, topics::kRunTrial, /*auto_start=*/false),
      answer_last_image_(boost::make_shared<Callback>([this] {
        if (last_image_ != nullptr) answer(*last_image_);
      })),
      finish_(boost::make_shared<Callback>([this] { onFinish(); })),
      image_spinner_(/*thread_count=*/1, &image_queue_),
      applied_spinner_(/*thread_count=*/1, &applied_queue_),
      options_spinner_(/*thread_count=*/1, &options_queue_) {
  if (controller.publish_effort) effort_.emplace(nh, controller.torque_dim);
  server_.registerGoalCallback([this] { onGoal(); });
  server_.registerPreemptCallback([this] { onPreempt(); });
  model_sub_ = nh.subscribe(topics::kModel, 1, &MpcNode::onModel, this);
  goal_image_sub_ = nh.subscribe(topics::kGoalImage, 1, &MpcNode::onGoalImage, this);
  timer_ = nh.createSteadyTimer(kTick, [this](const ros::SteadyTimerEvent&) { onTick(); });
  applied_sub_ = withQueue(nh, &applied_queue_)
                     .subscribe(topics::kAppliedTorque, kQueue, &MpcNode::onApplied, this,
                                ros::TransportHints().tcpNoDelay());
  image_sub_ = transport_.subscribe(
      topics::kImage, 1, &MpcNode::onImage, this,
      image_transport::TransportHints("raw", ros::TransportHints().tcpNoDelay()));
  applied_spinner_.start();
  image_spinner_.start();
  options_spinner_.start();
  server_.start();  // last: whoever sees the action finds everything else in place
}

MpcNode::~MpcNode() {
  stop();                 // else the spinner would wait for a plan
  image_spinner_.stop();  // no callback is running from here on
  applied_spinner_.stop();
  options_spinner_.stop();
}

bool MpcNode::stop() {
  if (goal_ == nullptr) return false;
  endTrial();
  return true;
}

void MpcNode::onGoal() {
  // Whoever sees the goal accepted may send an image at once: it waits here until there is a trial to answer it.
  std::unique_lock<std::mutex> lock(mutex_);
  goal_ = server_.acceptNewGoal();
  health_.expect(ControlHealth::Expected::kModel);
  last_progress_ = ros::SteadyTime::now();
  if (effort_) {
    const std::string others = otherPublishers(effort_->topic());
    if (!others.empty()) {
      lock.unlock();
      abort({"trial refused: " + others + " also publish(es) " + effort_->topic() +
                 ", and a motor must have one master: set controller/publish_effort to false, as "
                 "next to robot_node",
             ""});
      return;
    }
  }
  beginIfReady(std::move(lock));
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
    log_.info("model " + model_id_ + " of trial " + std::to_string(message->trial) + " received");
  } catch (const std::exception& e) {
    log_.error(std::string("model refused: ") + e.what());
    return;
  }
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

/// Starts the trial once its model and its goal image are there.
/// @param lock  of mutex_
void MpcNode::beginIfReady(std::unique_lock<std::mutex> lock) {
  if (goal_ == nullptr || trial_ != nullptr) return;
  if (!goal_->model_id.empty() && goal_->model_id != model_id_) return;
  if (!goalImageIsThere()) return;
  try {
    trial_ =
        std::make_shared<TrialRun>(*goal_, goal_->model_id.empty() ? nullptr : model_, goal_image_,
                                   image_size_, mpc_, controller_, turned_epsilon_);
    const std::lock_guard<std::mutex> applied_lock(applied_mutex_);
    applied_.clear();  // a simulator that was started again uses its stamps again
    turned_ = false;
    goal_changed_ = false;
    last_progress_ = ros::SteadyTime::now();
  } catch (const std::exception& e) {
    lock.unlock();
    abort({std::string("trial refused: ") + e.what(), ""});
    return;
  }
  lock.unlock();
  fed_back_ = 0;
  health_.expect(ControlHealth::Expected::kImage);
  // In lock-step the first image may have come before the goal; there will be no second one.
  if (!goal_->start.isZero()) image_queue_.addCallback(answer_last_image_);
}

/// Locked by the caller.
bool MpcNode::goalImageIsThere() const {
  if (goal_->goal.isZero()) return true;
  return goal_image_ != nullptr && goal_image_->header.stamp == goal_->goal;
}

void MpcNode::onTurn(const MpcOptions& mpc) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (mpc.epsilon != mpc_.epsilon) turned_epsilon_ = mpc.epsilon;
  mpc_ = mpc;
  turned_ = true;
}

void MpcNode::onImage(const sensor_msgs::ImageConstPtr& image) {
  last_image_ = image;
  health_.countImage();
  answer(*image);
}

void MpcNode::answer(const sensor_msgs::Image& image) {
  const auto arrival = std::chrono::steady_clock::now();
  Changes changes;
  const std::shared_ptr<TrialRun> trial = trialToAnswer(&changes);
  if (trial == nullptr) return;
  Trouble trouble;
  const std::optional<Decision> decision = decide(trial.get(), changes, image, arrival, &trouble);

  const std::lock_guard<std::mutex> lock(mutex_);
  deciding_since_.reset();
  if (trial->ended()) return;  // meanwhile: its motors have their zero
  if (!trouble.text.empty()) {
    publishTorque(image.header.stamp, Eigen::VectorXd::Zero(controller_.torque_dim), false);
  } else if (decision) {
    last_progress_ = ros::SteadyTime::now();
    if (trial->result().num_steps == 0) scalars_.forget();
    trial->collect(image.header.stamp, *decision);
    publish(image.header, *decision);
    if (!trial->done()) return;
  } else {
    return;
  }
  trial->end();
  finished_ = trouble;
  ros::getGlobalCallbackQueue()->addCallback(finish_);
}

/// The trial under way; null if there is none.
/// @param changes  out: what the trial does not know yet
std::shared_ptr<TrialRun> MpcNode::trialToAnswer(Changes* changes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (trial_ == nullptr || trial_->ended()) return nullptr;
  if (turned_) changes->mpc = mpc_;
  turned_ = false;
  changes->epsilon = turned_epsilon_;
  if (goal_changed_) changes->goal_image = goal_image_;
  goal_changed_ = false;
  deciding_since_ = ros::SteadyTime::now();
  return trial_;
}

/// Without the lock: another goal or epsilon may take as long as a plan.
/// @param trouble  out: why the image cannot be answered
std::optional<Decision> MpcNode::decide(TrialRun* trial, const Changes& changes,
                                        const sensor_msgs::Image& image,
                                        std::chrono::steady_clock::time_point arrival,
                                        Trouble* trouble) {
  if (image_sub_.getNumPublishers() > 1) {
    trouble->text = "image refused: only one node may publish images: stop the others";
    trouble->topic = image_sub_.getTopic();
    return std::nullopt;
  }
  try {
    if (changes.mpc) trial->turn(*changes.mpc, changes.epsilon);
    if (changes.goal_image != nullptr) trial->setGoal(*changes.goal_image);
    if (const std::optional<ros::Time> last = trial->lastAnswered()) {
      const ddm_msgs::TorqueConstPtr applied = waitForApplied(*last);
      if (applied != nullptr) trial->takeApplied(*applied);
    }
    return trial->decide(image, arrival);
  } catch (const std::exception& e) {
    trouble->text = std::string("image refused: ") + e.what();
    return std::nullopt;
  }
}

void MpcNode::onApplied(const ddm_msgs::TorqueConstPtr& applied) {
  {
    const std::lock_guard<std::mutex> lock(applied_mutex_);
    applied_[applied->header.stamp] = applied;
    if (applied_.size() > kMaxApplied) applied_.erase(applied_.begin());
  }
  applied_came_.notify_one();
}

/// What acted after an image. It is sent at about the time of the next image, and may come later.
/// @return null if nobody says so: then what was decided is taken to have acted
ddm_msgs::TorqueConstPtr MpcNode::waitForApplied(const ros::Time& stamp) {
  if (applied_sub_.getNumPublishers() == 0) return nullptr;
  std::unique_lock<std::mutex> lock(applied_mutex_);
  applied_came_.wait_for(lock, kAppliedLimit,
                         [&] { return applied_.lower_bound(stamp) != applied_.end(); });
  const auto found = applied_.find(stamp);
  return found == applied_.end() ? nullptr : found->second;
}

void MpcNode::publish(const std_msgs::Header& header, const Decision& decision) {
  publishTorque(header.stamp, decision.torque, decision.exploratory);
  if (decision.plan) publishPlan(header.stamp, *decision.plan);
  if (decision.plan && scalars_pub_.getNumSubscribers() > 0) {
    scalars_pub_.publish(scalars_.of(header.stamp, *decision.plan, decision.goal_distance));
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
  if (effort_) effort_->publish(message.torque);
}

void MpcNode::publishPlan(const ros::Time& stamp, const Plan& plan) {
  health_.countPlan(plan);
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (plan.status == PlanStatus::kFailed && now - last_plan_log_ >= kPlanLogPeriod) {
    last_plan_log_ = now;
    log_.warn("plan failed, the torque is 0: " + plan.message);
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
  message.status = statusOf(plan);
  message.message = plan.message;
  message.solve_time = plan.solve_time;
  plan_pub_.publish(message);
}

/// The thread of the images has ended the trial.
void MpcNode::onFinish() {
  Trouble trouble;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!finished_) return;  // it was cancelled before this was called
    trouble = *finished_;
  }
  if (!trouble.text.empty()) {
    abort(trouble);
    return;
  }
  const ddm_msgs::RunTrialGoalConstPtr goal = goal_;
  const ddm_msgs::RunTrialResult result = endTrial();
  std::ostringstream text;
  text << "trial " << goal->trial << (goal->evaluation != 0 ? " (evaluation)" : "") << ": "
       << result.num_steps << " torques, " << result.num_exploratory << " exploratory, "
       << result.num_failed_plans << " failed plans, " << result.num_cut_plans << " cut short";
  log_.info(text.str());
  server_.setSucceeded(result);
}

void MpcNode::onTick() {
  if (goal_ == nullptr) return;
  publishFeedback();
  const std::optional<Trouble> silence = describeSilence();
  if (silence) abort(*silence);
}

void MpcNode::publishFeedback() {
  ddm_msgs::RunTrialFeedback feedback;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (trial_ != nullptr) feedback.step = trial_->result().num_steps;
  }
  if (feedback.step == fed_back_) return;
  fed_back_ = feedback.step;
  server_.publishFeedback(feedback);
}

/// What keeps the trial waiting for longer than its timeout; empty: nothing.
std::optional<MpcNode::Trouble> MpcNode::describeSilence() {
  std::ostringstream reason;
  std::string topic = model_sub_.getTopic();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (finished_) return std::nullopt;
  const ros::SteadyTime since = std::max(last_progress_, deciding_since_.value_or(last_progress_));
  if ((ros::SteadyTime::now() - since).toSec() <= controller_.timeout) return std::nullopt;
  if (trial_ == nullptr) {
    const bool is_goal = goal_->model_id.empty() || goal_->model_id == model_id_;
    reason << (is_goal ? "the goal image of the trial" : "model " + goal_->model_id)
           << " did not come";
    if (is_goal) topic = goal_image_sub_.getTopic();
  } else if (deciding_since_) {
    reason << "no plan for step " << trial_->result().num_steps + 1;
    topic.clear();
  } else {
    reason << "no image after step " << trial_->result().num_steps;
    topic = image_sub_.getTopic();
  }
  reason << " within " << controller_.timeout << " s";
  if (topic.empty()) reason << ": set mpc/time_budget";
  return Trouble{reason.str(), topic};
}

/// However a trial ends, an effort controller must not go on with its last torque.
ddm_msgs::RunTrialResult MpcNode::endTrial() {
  goal_.reset();
  health_.expect(ControlHealth::Expected::kNothing);
  const std::lock_guard<std::mutex> lock(mutex_);
  ddm_msgs::RunTrialResult result;
  if (trial_ != nullptr) {
    result = trial_->result();
    trial_->end();
  }
  trial_.reset();
  finished_.reset();
  if (effort_) effort_->publishZero();
  return result;
}

/// The zero first: the master may keep whoever asks it waiting.
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

namespace {

const ros::WallDuration kLook(0.05);

void run(const ros::NodeHandle& nh, const ros::NodeHandle& pnh, ddm::ParamReader* params) {
  params->ignore("image_transport");    // read by image_transport itself
  params->ignore("diagnostic_period");  // and by diagnostic_updater
  const auto image = params->read<ddm::ImageOptions>("image");
  const auto mpc = params->read<ddm::MpcOptions>("mpc");
  const auto controller = params->read<ddm::ControllerOptions>("controller");
  params->requireValid();
  ROS_INFO_STREAM("mpc_node runs with\n" << ddm::toYaml(mpc) << "\n" << ddm::toYaml(controller));
  ddm::MpcNode node(nh, pnh, image.size, mpc, controller);
  ddm::runUntilEnd([] { ros::getGlobalCallbackQueue()->callAvailable(kLook); },
                   [&node] { return node.stop(); });
}

}  // namespace

int main(int argc, char** argv) {
  ddm::silenceSolverLog();
  return ddm::runNode("mpc_node", argc, argv, run, ddm::Ending::kByLastMessage);
}
