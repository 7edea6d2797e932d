// One trial: decides which images belong to it, and collects its result.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_msgs/RunTrialAction.h>
#include <ddm_msgs/Torque.h>
#include <sensor_msgs/Image.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>

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
           const ControllerOptions& controller);

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
                                 std::chrono::steady_clock::time_point arrival);

  /// @return whether the goal gives the stamp of the first image of the trial
  bool startIsGiven() const { return start_is_given_; }

  /// @return stamp of the last answered image; empty before the first
  std::optional<ros::Time> lastAnswered() const {
    return answered_ ? std::make_optional(last_stamp_) : std::nullopt;
  }

  /// Adds the torque that acted after the last answered image (topic `applied_torque`). An empty
  /// torque means that no single torque acted, and begins a new segment.
  /// @throws std::invalid_argument unless it is empty or has one finite number for each motor
  void takeApplied(const ddm_msgs::Torque& applied);

  /// Sets the goal of the plans from the next image on.
  /// @throws std::invalid_argument for an image that cannot be decoded; the goal then stays
  void setGoal(const sensor_msgs::Image& goal);

  /// Adds a published decision to the result.
  void collect(const ros::Time& stamp, const Decision& decision);

  /// Ends the trial: no further image is answered. Any thread may call this function. It stops the
  /// search of a running decide(), and the caller discards that decision.
  void end() { ended_ = true; }
  bool ended() const { return ended_; }

  bool done() const { return result_.num_steps == num_steps_; }
  const ddm_msgs::RunTrialResult& result() const { return result_; }

 private:
  bool isGap(double interval);

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
