// One trial under way: which images belong to it, and what has been answered so far.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_images/image_codec.h>
#include <ddm_model/ddm.h>
#include <ddm_model/per_motor.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "controller_options.h"
#include "ddm_mpc/epsilon_greedy.h"
#include "ddm_mpc/mpc_options.h"
#include "ddm_mpc/mpc_policy.h"

namespace ddm {

/// Turns the images of one `run_trial` goal into decisions and collects the result. One thread at a
/// time calls decide() and turn(); the caller guards the other functions by a mutex of its own,
/// which it need not hold while decide() plans.
class TrialRun {
 public:
  /// @param model       may be null where goal.epsilon = 1
  /// @param goal_image  to plan to; null: the model's
  /// @param epsilon     instead of the goal's, but in an evaluation; empty: the goal's
  /// @throws std::invalid_argument if goal, model and options do not fit together
  TrialRun(const ddm_msgs::RunTrialGoal& goal, std::shared_ptr<const Ddm> model,
           const sensor_msgs::ImageConstPtr& goal_image, int image_size, const MpcOptions& mpc,
           const ControllerOptions& controller, const std::optional<double>& epsilon)
      : num_steps_(goal.num_steps),
        image_size_(image_size),
        dt_(controller.dt),
        evaluation_(goal.evaluation != 0),
        greedy_(makePolicy(std::move(model), image_size, mpc, controller)),
        policy_(greedy_, explorationOf(goal, mpc, controller, epsilon),
                TrialId{goal.seed, goal.trial, evaluation_}) {
    if (greedy_ != nullptr) greedy_->setStop([this] { return ended(); });
    if (goal_image != nullptr) setGoal(*goal_image);
    if (greedy_ != nullptr && !greedy_->hasGoal()) {
      throw std::invalid_argument(
          "there is no goal image to plan to: publish one on goal_image, or "
          "train the model with one");
    }
    if (num_steps_ < 1) throw std::invalid_argument("num_steps must be >= 1, got 0");
    if (greedy_ != nullptr) greedy_->prepare();  // before the first image: no torque is late for it
    if (!goal.start.isZero()) last_stamp_ = goal.start - ros::Duration(0, 1);
  }

  /// @param arrival  of the image: mpc/time_budget begins there
  /// @return the decision, or nothing for an image that is not the next of this trial: one from
  ///         before its start, or one that was already answered
  /// @throws std::invalid_argument for an image that cannot be used, that has no stamp, or whose
  ///         size or encoding differs from those before
  std::optional<Decision> decide(
      const sensor_msgs::Image& image,
      std::chrono::steady_clock::time_point arrival = std::chrono::steady_clock::now()) {
    if (image.header.stamp.isZero()) {
      throw std::invalid_argument(
          "it has no stamp, which pairs it with its torque: set it in the camera driver");
    }
    if (image.header.stamp <= last_stamp_) return std::nullopt;
    const std::string camera =
        std::to_string(image.width) + "x" + std::to_string(image.height) + " " + image.encoding;
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

  /// Stamp of the last image that was answered; empty before the first.
  std::optional<ros::Time> lastAnswered() const {
    return answered_ ? std::make_optional(last_stamp_) : std::nullopt;
  }

  /// What acted after the last image that was answered, see topic `applied_torque`.
  /// @throws std::invalid_argument if it is neither empty nor one finite number for each motor
  void takeApplied(const ddm_msgs::Torque& applied) {
    if (applied.torque.empty()) {
      policy_.startSegment();
    } else {
      policy_.correctTorque(Eigen::Map<const Eigen::VectorXd>(
          applied.torque.data(), static_cast<Eigen::Index>(applied.torque.size())));
    }
  }

  /// From the next image on, plans with these, and explores with this epsilon instead of the
  /// goal's. A random trial plans nothing, and an evaluation does not explore.
  void turn(const MpcOptions& mpc, const std::optional<double>& epsilon) {
    if (greedy_ == nullptr) return;
    greedy_->setHorizon(mpc.horizon);
    greedy_->setControlWeight(mpc.control_weight);
    if (epsilon && !evaluation_) policy_.setEpsilon(*epsilon);
  }

  /// From the next image on, plans to this goal.
  /// @throws std::invalid_argument for an image that cannot be used; nothing has changed
  void setGoal(const sensor_msgs::Image& goal) { policy_.setGoal(decodeImage(goal, image_size_)); }

  /// Adds a decision that was published to the result.
  void collect(const ros::Time& stamp, const Decision& decision) {
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

  /// No image is answered from here on. From any thread: a decide() under way ends its search, and
  /// what it returns no longer counts.
  void end() { ended_ = true; }
  bool ended() const { return ended_; }

  bool done() const { return result_.num_steps == num_steps_; }
  const ddm_msgs::RunTrialResult& result() const { return result_; }

 private:
  static constexpr double kGap = 1.5;  // in time steps, as where bags are read

  /// Whether images are missing in between.
  /// @param interval  between two images [s]
  bool isGap(double interval) {
    shortest_interval_ = std::min(shortest_interval_, interval);
    return interval > kGap * (dt_ > 0.0 ? dt_ : shortest_interval_);
  }

  static std::shared_ptr<MpcPolicy> makePolicy(std::shared_ptr<const Ddm> model, int image_size,
                                               const MpcOptions& mpc,
                                               const ControllerOptions& controller) {
    if (model == nullptr) return nullptr;
    if (model->imageSize() != image_size || model->torqueDim() != controller.torque_dim) {
      throw std::invalid_argument(
          "the model has images of size " + std::to_string(model->imageSize()) + " and " +
          std::to_string(model->torqueDim()) + " torque(s), this node has image/size " +
          std::to_string(image_size) + " and controller/torque_dim " +
          std::to_string(controller.torque_dim) + ": start both with the same configuration");
    }
    return std::make_shared<MpcPolicy>(std::move(model), mpc);
  }

  EpsilonGreedy::Options explorationOf(const ddm_msgs::RunTrialGoal& goal, const MpcOptions& mpc,
                                       const ControllerOptions& controller,
                                       const std::optional<double>& epsilon) const {
    EpsilonGreedy::Options options;
    options.epsilon =
        greedy_ != nullptr && !evaluation_ ? epsilon.value_or(goal.epsilon) : goal.epsilon;
    options.hold_steps = static_cast<int>(goal.hold_steps);
    options.max_torque = perMotor(mpc.max_torque, controller.torque_dim, "mpc/max_torque");
    return options;
  }

  std::uint32_t num_steps_;
  int image_size_;
  double dt_;  // 0: not known [s]
  bool evaluation_;
  ros::Time last_stamp_;   // images up to this one do not count
  bool answered_ = false;  // an image of this trial
  double shortest_interval_ = std::numeric_limits<double>::infinity();  // between images [s]
  std::string camera_;                 // size and encoding of the images
  std::shared_ptr<MpcPolicy> greedy_;  // null: a random trial
  EpsilonGreedy policy_;
  std::atomic<bool> ended_{false};
  ddm_msgs::RunTrialResult result_;
};

}  // namespace ddm
