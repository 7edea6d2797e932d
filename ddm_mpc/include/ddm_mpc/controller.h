// The controller: the paper's MPC on images, and epsilon-greedy exploration around it.
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

/// Receding-horizon policy in feature space: encodes each image, keeps the state x, and plans towards
/// the feature of the goal image (paper, Sec. 3.1), which is the model's own until there is another.
/// mpc/time_budget covers the whole decision, from the arrival of the image on, but does not cut
/// short what prepare() computes. An offset is added to each prediction and follows their errors,
///
///   offset <- offset + offset_gain (z_{t+1} - z_{t+1|t} - offset)
///
/// so that the plant reaches its goal although the model is a little wrong about states at rest.
class MpcPolicy : public Policy {
 public:
  /// @throws std::invalid_argument if max_torque exceeds the model's or is for another number of motors; with mpc/cost time
  ///         also if the model has fewer than two support states, or more motors than CostToGo takes
  MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options);

  void startTrial(const TrialId& id) override;
  void startSegment() override;
  void setExploring(bool exploring) override { exploring_ = exploring; }
  void setGoal(const Grey& goal) override { z_ref_ = model_->encode(goal); }
  bool hasGoal() const { return z_ref_.size() > 0; }

  /// Computes the cost-to-go of this goal, if it is not known yet: up to two seconds with mpc/cost
  /// time. Optional: plan() calls it. Call it before the first image so that no torque is late.
  /// @pre hasGoal()
  void prepare() { cost_.setGoal(z_ref_, exploring_); }

  /// Sets the time at which the next image arrived. Without it the time budget begins with observe().
  void setArrival(std::chrono::steady_clock::time_point arrival) { arrival_ = arrival; }

  /// Sets a condition that ends the search for a plan. It is checked before each evaluation of the cost.
  void setStop(std::function<bool()> stop) { stop_ = std::move(stop); }

  void observe(const Grey& grey) override;
  /// |z - z_ref| in units of the features' spread; empty if the model does not know the spread, or
  /// there is no goal.
  std::optional<double> goalDistance() const override;
  /// The plan from the state now on.
  /// @throws std::logic_error if there is no goal
  Plan plan();
  Answer answer() override { return answerWith(plan()); }
  void apply(const Eigen::VectorXd& u) override;

 private:
  std::shared_ptr<const Ddm> model_;
  double offset_gain_;
  std::chrono::duration<double> time_budget_;
  std::optional<std::chrono::steady_clock::time_point> arrival_;  // of the next image
  std::chrono::steady_clock::time_point began_;                   // the decision under way
  std::function<bool()> stop_;
  bool exploring_ = false;
  Eigen::VectorXd z_ref_;  // empty: no goal  [feature_dim]
  History x_;
  Eigen::VectorXd offset_;     // [feature_dim]
  Eigen::VectorXd predicted_;  // z_{t+1|t}, empty before the first torque  [feature_dim]
  DdmPlanCost cost_;
  Planner planner_;
  std::mt19937_64 rng_;
};

/// The decision for one image.
struct Decision {
  Eigen::VectorXd torque;               ///< u_t [N m]                     [torque_dim]
  bool exploratory = false;             ///< a random torque
  std::optional<double> solve_time;     ///< see Answer; empty where exploratory [s]
  std::optional<Plan> plan;             ///< of a policy that plans; empty where exploratory
  std::optional<double> goal_distance;  ///< see Policy::goalDistance()
};

/// With probability epsilon a random torque, otherwise the policy's answer (paper, Sec. 3.2). epsilon
/// = 1 is the random trial, 0 the greedy one. A random torque is uniform in +-max_torque and held for
/// hold_steps steps. Exploration has a random stream of its own.
class EpsilonGreedy {
 public:
  struct Options {
    double epsilon = 0.2;  ///< [-]
    int hold_steps = 1;    ///< how long a random torque is held [-]
    Eigen::VectorXd max_torque = Eigen::VectorXd::Constant(1, 6.0);  ///< of each motor [N m]
  };

  /// @param policy  may be null where epsilon = 1
  /// @throws std::invalid_argument if options are out of range or the policy is missing
  EpsilonGreedy(std::shared_ptr<Policy> policy, const Options& options, const TrialId& id);

  /// See Policy::setGoal().
  void setGoal(const Grey& goal);

  /// Says that another torque acted than the last one decided. To be called before the next decide().
  /// @param torque  [N m]                                                          [torque_dim]
  /// @throws std::invalid_argument if it is not one finite number for each motor
  void correctTorque(const Eigen::VectorXd& torque);

  /// See Policy::startSegment(). To be called before the next decide().
  void startSegment();

  /// @param grey  the image just seen
  /// @throws std::invalid_argument for a wrong number of pixels
  Decision decide(const Grey& grey);

 private:
  void drawTorque();

  std::shared_ptr<Policy> policy_;
  Options options_;
  std::mt19937_64 rng_;
  std::optional<Eigen::VectorXd> acted_;  // between the last image and the next; empty: unknown
  Eigen::VectorXd held_torque_;
  int held_steps_left_ = 0;
};

}  // namespace ddm
