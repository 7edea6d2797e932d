// One trial: decides which images belong to it, and collects its result.
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_run.h"

#include <ddm_common/image_codec.h>
#include <ddm_model/per_motor.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

constexpr double kGap = 1.5;  // gap / time step, the same as in the reader of bags

std::shared_ptr<MpcPolicy> makePolicy(std::shared_ptr<const Ddm> model, int image_size,
                                      const MpcOptions& mpc, const ControllerOptions& controller) {
  if (model == nullptr) return nullptr;
  if (model->imageSize() != image_size || model->torqueDim() != controller.torque_dim) {
    throw std::invalid_argument(
        textOf("the model has images of size ", model->imageSize(), " and ", model->torqueDim(),
               " torque(s), this node has image/size ", image_size, " and controller/torque_dim ",
               controller.torque_dim, ": start both with the same configuration"));
  }
  return std::make_shared<MpcPolicy>(std::move(model), mpc);
}

EpsilonGreedy::Options explorationOf(const ddm_msgs::RunTrialGoal& goal, const MpcOptions& mpc,
                                     const ControllerOptions& controller) {
  EpsilonGreedy::Options options;
  options.epsilon = goal.epsilon;
  options.hold_steps = static_cast<int>(goal.hold_steps);
  options.max_torque = perMotor(mpc.max_torque, controller.torque_dim, "mpc/max_torque");
  return options;
}

}  // namespace

TrialRun::TrialRun(const ddm_msgs::RunTrialGoal& goal, std::shared_ptr<const Ddm> model,
                   const sensor_msgs::ImageConstPtr& goal_image, int image_size,
                   const MpcOptions& mpc, const ControllerOptions& controller)
    : num_steps_(goal.num_steps),
      start_is_given_(!goal.start.isZero()),
      image_size_(image_size),
      dt_(controller.dt),
      greedy_(makePolicy(std::move(model), image_size, mpc, controller)),
      policy_(greedy_, explorationOf(goal, mpc, controller),
              TrialId{goal.seed, goal.trial, goal.evaluation != 0}) {
  if (num_steps_ < 1) throw std::invalid_argument("num_steps must be >= 1, got 0");
  if (start_is_given_) last_stamp_ = goal.start - ros::Duration(0, 1);
  if (goal_image != nullptr) setGoal(*goal_image);
  if (greedy_ == nullptr) return;
  if (!greedy_->hasGoal()) {
    throw std::invalid_argument(
        "there is no goal image to plan to: publish one on goal_image, or train the model with "
        "one");
  }
  greedy_->setStop([this] { return ended(); });
}

std::optional<Decision> TrialRun::decide(const sensor_msgs::Image& image,
                                         std::chrono::steady_clock::time_point arrival) {
  if (image.header.stamp.isZero()) {
    throw std::invalid_argument(
        "it has no stamp, which pairs it with its torque: set it in the camera driver");
  }
  if (image.header.stamp <= last_stamp_) return std::nullopt;
  const std::string camera = textOf(image.width, "x", image.height, " ", image.encoding);
  if (camera_.empty()) camera_ = camera;
  if (camera != camera_) {
    throw std::invalid_argument("the images change from " + camera_ + " to " + camera);
  }
  const double interval = (image.header.stamp - last_stamp_).toSec();
  if (answered_ && isGap(interval)) policy_.startSegment();
  if (greedy_ != nullptr) greedy_->setArrival(arrival);
  Decision decision = policy_.decide(decodeImage(image, image_size_));
  last_stamp_ = image.header.stamp;
  answered_ = true;
  return decision;
}

/// @param interval  time between two images [s]
/// @return          whether images are missing between them
bool TrialRun::isGap(double interval) {
  shortest_interval_ = std::min(shortest_interval_, interval);
  return interval > kGap * (dt_ > 0.0 ? dt_ : shortest_interval_);
}

void TrialRun::takeApplied(const ddm_msgs::Torque& applied) {
  if (applied.torque.empty()) {
    policy_.startSegment();
  } else {
    policy_.correctTorque(Eigen::Map<const Eigen::VectorXd>(
        applied.torque.data(), static_cast<Eigen::Index>(applied.torque.size())));
  }
}

void TrialRun::setGoal(const sensor_msgs::Image& goal) {
  policy_.setGoal(decodeImage(goal, image_size_));
}

void TrialRun::collect(const ros::Time& stamp, const Decision& decision) {
  ++result_.num_steps;
  result_.last = stamp;
  result_.stamp.push_back(stamp);
  for (Eigen::Index i = 0; i < decision.torque.size(); ++i) {
    result_.torque.push_back(decision.torque[i]);
  }
  result_.exploratory.push_back(decision.exploratory);
  if (decision.goal_distance) result_.goal_distance.push_back(*decision.goal_distance);
  if (decision.exploratory) ++result_.num_exploratory;
  if (!decision.plan) return;
  result_.solve_time.push_back(decision.plan->solve_time);
  if (decision.plan->status == PlanStatus::kFailed) ++result_.num_failed_plans;
  if (decision.plan->status == PlanStatus::kTimeLimit) ++result_.num_cut_plans;
}

}  // namespace ddm
