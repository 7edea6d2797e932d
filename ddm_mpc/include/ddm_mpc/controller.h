// The controller: MPC on images (paper, Sec. 3.1), and epsilon-greedy exploration (Sec. 3.2).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <utility>

#include "ddm_mpc/ddm_plan_cost.h"
#include "ddm_mpc/mpc_options.h"
#include "ddm_mpc/planner.h"
#include "ddm_mpc/policy.h"

namespace ddm {

/// Receding-horizon policy in feature space (paper, Sec. 3.1): encodes each image (eq. 3a), keeps
/// the controller state x (eq. 8) and plans towards the goal feature (eq. 9). The goal is that of
/// the model until setGoal() is called. mpc/time_budget limits the time from the arrival of an
/// image to the end of the search for a plan, but not the time of prepare().
///
/// Deviation: each prediction gets an offset, which follows the prediction errors,
///
///   offset <- offset + offset_gain (z_{t+1} - z_{t+1|t} - offset)
///
/// so that the plant reaches its goal although the model predicts states at rest slightly wrong.
class MpcPolicy : public Policy {
 public:
  /// @param model  trained model, not null
  /// @throws std::invalid_argument if max_torque exceeds that of the model or has a wrong number of
  ///         entries. With mpc/cost time, also if the model has fewer than two support states or
  ///         more than SaturatingCost::kMaxMotors motors
  MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options);

  void startTrial(const TrialId& id) override;
  void startSegment() override;
  void setExploring(bool exploring) override { exploring_ = exploring; }
  void setGoal(const Image& goal) override { z_ref_ = model_->encode(goal); }
  bool hasGoal() const { return z_ref_.size() > 0; }

  /// Computes the cost-to-go of the goal if it is not yet computed, which takes up to two seconds
  /// with mpc/cost time. Optional: plan() calls it. Call it before the first image so that no
  /// torque is late.
  /// @pre hasGoal()
  void prepare() { cost_.setGoal(z_ref_, exploring_); }

  /// Sets the arrival of the next image, where its time budget begins. Default: the call of
  /// observe().
  void setArrival(std::chrono::steady_clock::time_point arrival) { arrival_ = arrival; }

  /// Sets a condition that ends the search for a plan; evaluations of the cost check it.
  void setStop(std::function<bool()> stop) { stop_ = std::move(stop); }

  void observe(const Image& image) override;
  /// @return |z - z_ref| in units of the spread of the features; empty if the model has no valid
  ///         spread or there is no goal
  std::optional<double> goalDistance() const override;
  /// Plans from the current state.
  /// @throws std::logic_error if there is no goal
  Plan plan();
  Answer answer() override { return answerWith(plan()); }
  void apply(const Eigen::VectorXd& u) override;

 private:
  std::shared_ptr<const Ddm> model_;
  double offset_gain_;
  std::chrono::duration<double> time_budget_;
  // Arrival of the next image; empty: not set.
  std::optional<std::chrono::steady_clock::time_point> arrival_;
  std::chrono::steady_clock::time_point began_;  // start of the current decision
  std::function<bool()> stop_;
  bool exploring_ = false;
  Eigen::VectorXd z_ref_;  // empty: no goal  [feature_dim]
  History x_;
  Eigen::VectorXd offset_;     // [feature_dim]
  Eigen::VectorXd predicted_;  // z_{t+1|t}; empty before the first torque  [feature_dim]
  DdmPlanCost cost_;
  Planner planner_;
  std::mt19937_64 rng_;
};

/// The decision for one image.
struct Decision {
  Eigen::VectorXd torque;               ///< u_t [N m]                     [torque_dim]
  bool exploratory = false;             ///< whether the torque is random
  std::optional<double> solve_time;     ///< see Answer; empty if exploratory [s]
  std::optional<Plan> plan;             ///< see Answer; empty if exploratory
  std::optional<double> goal_distance;  ///< see Policy::goalDistance()
};

/// Epsilon-greedy exploration (paper, Sec. 3.2): with probability epsilon a random torque,
/// otherwise the answer of the policy. In the random trial epsilon is 1, in an evaluation 0. A
/// random torque is uniform in +-max_torque and is held for 1 ... hold_steps steps. Exploration has its
/// own random stream.
class EpsilonGreedy {
 public:
  struct Options {
    double epsilon = 0.2;  ///< probability of a random torque [-]
    int hold_steps = 1;    ///< largest number of steps for which a random torque is held [-]
    Eigen::VectorXd max_torque = Eigen::VectorXd::Constant(1, 6.0);  ///< of each motor [N m]
  };

  /// @param policy  may be null if epsilon = 1
  /// @param id      identifies the trial; seeds the random streams
  /// @throws std::invalid_argument if an option is out of range, or if the policy is missing
  EpsilonGreedy(std::shared_ptr<Policy> policy, const Options& options, const TrialId& id);

  /// See Policy::setGoal().
  void setGoal(const Image& goal);

  /// Replaces the last decided torque in the controller state by the torque that acted instead.
  /// Call it before the next decide().
  /// @param torque  [N m]                                                          [torque_dim]
  /// @throws std::invalid_argument unless it is one finite number for each motor
  void correctTorque(const Eigen::VectorXd& torque);

  /// See Policy::startSegment(). Call it before the next decide().
  void startSegment();

  /// Performs one step of Algorithm 1 of the paper.
  /// @param image  the newest image  [D]
  /// @throws std::invalid_argument for a wrong number of pixels
  Decision decide(const Image& image);

 private:
  void drawTorque();

  std::shared_ptr<Policy> policy_;
  Options options_;
  std::mt19937_64 rng_;
  // Torque between the last image and the next; empty: unknown.
  std::optional<Eigen::VectorXd> acted_;
  Eigen::VectorXd held_torque_;
  int held_steps_left_ = 0;
};

}  // namespace ddm
