// One trial under way: which images belong to it, and what has been answered so far.
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

/// Turns the images of one `run_trial` goal into decisions and collects the result. One thread at a
/// time calls decide(); the caller guards the other functions by a mutex of its own, which it need
/// not hold while decide() plans.
class TrialRun {
 public:
  /// @param model       may be null where goal.epsilon = 1
  /// @param goal_image  to plan to; null: the model's
  /// @throws std::invalid_argument if goal, model and options do not fit together
  TrialRun(const ddm_msgs::RunTrialGoal& goal, std::shared_ptr<const Ddm> model,
           const sensor_msgs::ImageConstPtr& goal_image, int image_size, const MpcOptions& mpc,
           const ControllerOptions& controller);

  /// Computes what the first plan needs, so that its torque is not late: the cost-to-go takes up to two
  /// seconds.
  void prepare() {
    if (greedy_ != nullptr) greedy_->prepare();
  }

  /// @param arrival  of the image: mpc/time_budget begins there
  /// @return the decision, or nothing for an image that is not the next of this trial: one from
  ///         before its start, or one that was already answered
  /// @throws std::invalid_argument for an image that cannot be used, that has no stamp, or whose
  ///         size or encoding differs from those before
  std::optional<Decision> decide(const sensor_msgs::Image& image,
                                 std::chrono::steady_clock::time_point arrival);

  /// Whether the goal says with which image the trial starts.
  bool startIsGiven() const { return start_is_given_; }

  /// Stamp of the last image that was answered; empty before the first.
  std::optional<ros::Time> lastAnswered() const {
    return answered_ ? std::make_optional(last_stamp_) : std::nullopt;
  }

  /// Takes in the torque that acted after the last image that was answered, see topic `applied_torque`.
  /// @throws std::invalid_argument if it is neither empty nor one finite number for each motor
  void takeApplied(const ddm_msgs::Torque& applied);

  /// From the next image on, plans to this goal.
  /// @throws std::invalid_argument for an image that cannot be used; nothing has changed
  void setGoal(const sensor_msgs::Image& goal);

  /// Adds a decision that was published to the result.
  void collect(const ros::Time& stamp, const Decision& decision);

  /// No image is answered from here on. May be called from any thread. A decide() under way ends its search,
  /// and its decision no longer counts.
  void end() { ended_ = true; }
  bool ended() const { return ended_; }

  bool done() const { return result_.num_steps == num_steps_; }
  const ddm_msgs::RunTrialResult& result() const { return result_; }

 private:
  bool isGap(double interval);

  std::uint32_t num_steps_;
  bool start_is_given_;
  int image_size_;
  double dt_;              // 0: not known [s]
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
