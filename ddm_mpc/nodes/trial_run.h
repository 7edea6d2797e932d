// One trial: decides which images belong to it, and collects its result.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/image_codec.h>
#include <ddm_common/option_checks.h>
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
#include <utility>

#include "ddm_mpc/controller.h"
#include "ddm_mpc/mpc_options.h"

namespace ddm {

/// Turns the images of one `run_trial` goal into decisions and collects the result. Only one thread
/// at a time may call decide(). The caller guards the other functions by its own mutex, which it
/// does not need to hold during decide().
class TrialRun {
 public:
  /// @param model       may be null if goal.epsilon = 1
  /// @param goal_image  goal of the plans; null: the goal image of the model
  /// @param image_size  width and height of the images after resizing [pixels]
  /// @throws std::invalid_argument if goal, model and options do not fit together
  TrialRun(const ddm_msgs::RunTrialGoal& goal, std::shared_ptr<const Ddm> model,
           const sensor_msgs::ImageConstPtr& goal_image, int image_size, const MpcOptions& mpc,
           const ControllerOptions& controller)
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

  /// Computes the cost-to-go, up to two seconds, so that the first torque is not late.
  void prepare() {
    if (greedy_ != nullptr) greedy_->prepare();
  }

  /// @param arrival  arrival of the image, where mpc/time_budget begins
  /// @return the decision; empty for an image that is not the next one of this trial, because it is
  ///         older than the trial or already answered
  /// @throws std::invalid_argument for an image that cannot be decoded, has no stamp, or differs in
  ///         size or encoding from those before
  std::optional<Decision> decide(const sensor_msgs::Image& image,
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
    if (answered_) {
      const double interval = (image.header.stamp - last_stamp_).toSec();
      shortest_interval_ = std::min(shortest_interval_, interval);
      const bool is_gap = interval > kGap * (dt_ > 0.0 ? dt_ : shortest_interval_);
      if (is_gap) policy_.startSegment();
    }
    if (greedy_ != nullptr) greedy_->setArrival(arrival);
    Decision decision = policy_.decide(decodeImage(image, image_size_));
    last_stamp_ = image.header.stamp;
    answered_ = true;
    return decision;
  }

  /// @return whether the goal gives the stamp of the first image of the trial
  bool startIsGiven() const { return start_is_given_; }

  /// @return stamp of the last answered image; empty before the first
  std::optional<ros::Time> lastAnswered() const {
    return answered_ ? std::make_optional(last_stamp_) : std::nullopt;
  }

  /// Adds the torque that acted after the last answered image (topic `applied_torque`). An empty
  /// torque means that no single torque acted, and begins a new segment.
  /// @throws std::invalid_argument unless it is empty or has one finite number for each motor
  void takeApplied(const ddm_msgs::Torque& applied) {
    if (applied.torque.empty()) {
      policy_.startSegment();
    } else {
      policy_.correctTorque(Eigen::Map<const Eigen::VectorXd>(
          applied.torque.data(), static_cast<Eigen::Index>(applied.torque.size())));
    }
  }

  /// Sets the goal of the plans from the next image on.
  /// @throws std::invalid_argument for an image that cannot be decoded; the goal then stays
  void setGoal(const sensor_msgs::Image& goal) { policy_.setGoal(decodeImage(goal, image_size_)); }

  /// Adds a published decision to the result.
  void collect(const ros::Time& stamp, const Decision& decision) {
    const Eigen::VectorXd& torque = decision.torque;
    ++result_.num_steps;
    result_.last = stamp;
    result_.stamp.push_back(stamp);
    result_.torque.insert(result_.torque.end(), torque.data(), torque.data() + torque.size());
    result_.exploratory.push_back(decision.exploratory);
    if (decision.goal_distance) result_.goal_distance.push_back(*decision.goal_distance);
    if (decision.exploratory) ++result_.num_exploratory;
    if (!decision.plan) return;
    result_.solve_time.push_back(decision.plan->solve_time);
    if (decision.plan->status == PlanStatus::kFailed) ++result_.num_failed_plans;
    if (decision.plan->status == PlanStatus::kTimeLimit) ++result_.num_cut_plans;
  }

  /// Ends the trial: no further image is answered. Any thread may call this function. It stops the
  /// search of a running decide(), and the caller discards that decision.
  void end() { ended_ = true; }
  bool ended() const { return ended_; }

  bool done() const { return result_.num_steps == num_steps_; }
  const ddm_msgs::RunTrialResult& result() const { return result_; }

 private:
  static constexpr double kGap = 1.5;  // gap / time step, the same as in the reader of bags

  static std::shared_ptr<MpcPolicy> makePolicy(std::shared_ptr<const Ddm> model, int image_size,
                                               const MpcOptions& mpc,
                                               const ControllerOptions& controller) {
    if (model == nullptr) return nullptr;
    if (model->imageSize() != image_size || model->torqueDim() != controller.torque_dim) {
      throw std::invalid_argument(
          textOf("the model has images of size ", model->imageSize(), " and ", model->torqueDim(),
                 " torque(s), this node has image/size ", image_size, " and controller/torque_dim ",
                 controller.torque_dim, ": start both with the same configuration"));
    }
    return std::make_shared<MpcPolicy>(std::move(model), mpc);
  }

  static EpsilonGreedy::Options explorationOf(const ddm_msgs::RunTrialGoal& goal,
                                              const MpcOptions& mpc,
                                              const ControllerOptions& controller) {
    EpsilonGreedy::Options options;
    options.epsilon = goal.epsilon;
    options.hold_steps = static_cast<int>(goal.hold_steps);
    options.max_torque = perMotor(mpc.max_torque, controller.torque_dim, "mpc/max_torque");
    return options;
  }

  std::uint32_t num_steps_;
  bool start_is_given_;
  int image_size_;
  double dt_;              // 0: unknown [s]
  ros::Time last_stamp_;   // images up to this stamp do not count
  bool answered_ = false;  // whether an image of this trial has been answered
  double shortest_interval_ = std::numeric_limits<double>::infinity();  // between images [s]
  std::string camera_;                 // size and encoding of the images
  std::shared_ptr<MpcPolicy> greedy_;  // null: random trial
  EpsilonGreedy policy_;
  std::atomic<bool> ended_{false};
  ddm_msgs::RunTrialResult result_;
};

}  // namespace ddm
