// Receding-horizon policy in feature space: the paper's MPC on images.
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

/// Encodes each image, keeps the state x, and plans towards the feature of the goal image
/// (paper, Sec. 3.1): the model's own until there is another. mpc/time_budget covers the whole
/// decision, from the arrival of the image on, but does not cut short what prepare() computes,
/// after another goal or a change of exploration. An offset is added to each prediction and follows
/// their errors,
///
///   offset <- offset + offset_gain (z_{t+1} - z_{t+1|t} - offset)
///
/// so that a model that is a little wrong about rest does not keep the plant off its goal.
class MpcPolicy : public Policy {
 public:
  /// @throws std::invalid_argument if max_torque exceeds the model's or is for another number of motors, or the horizon is
  ///         < 1; with mpc/cost time also if the model has fewer than two landmarks, or more motors than TimeToGoal takes
  MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options);

  /// Other values for the plans to come, also in the middle of a trial.
  /// @throws std::invalid_argument if the horizon is < 1
  void setHorizon(int horizon) { cost_.setHorizon(horizon); }
  void setControlWeight(double control_weight) { cost_.setControlWeight(control_weight); }

  /// When the image arrived that observe() takes in next; otherwise the budget begins there.
  void setArrival(std::chrono::steady_clock::time_point arrival) { arrival_ = arrival; }

  /// Another reason to end the search for a plan, asked before each evaluation of the cost.
  void setStop(std::function<bool()> stop) { stop_ = std::move(stop); }

  void startTrial(const TrialId& id) override;
  void startSegment() override;
  void setExploring(bool exploring) override { cost_.setExploring(exploring); }
  void setGoal(const Grey& goal) override {
    z_ref_ = model_->encode(goal);
    cost_.setGoal(z_ref_);
  }
  bool hasGoal() const { return z_ref_.size() > 0; }
  /// Computes now what the first plan to this goal would have to wait for.
  /// @pre hasGoal()
  void prepare() { cost_.prepare(); }
  void observe(const Grey& grey) override;
  /// |z - z_ref| in units of the features' spread; nothing if the model does not know the spread,
  /// or there is no goal.
  std::optional<double> goalDistance() const override;
  Answer answer() override { return answerWith(plan()); }
  /// The plan from the state now on.
  /// @throws std::logic_error if there is no goal
  Plan plan();
  void apply(const Eigen::VectorXd& u) override;

 private:
  std::shared_ptr<const Ddm> model_;
  double offset_gain_;
  std::chrono::duration<double> time_budget_;
  std::optional<std::chrono::steady_clock::time_point> arrival_;  // of the next image
  std::chrono::steady_clock::time_point began_;                   // the decision under way
  std::function<bool()> stop_;
  Eigen::VectorXd z_ref_;  // empty: no goal  [feature_dim]
  History x_;
  Eigen::VectorXd offset_;     // [feature_dim]
  Eigen::VectorXd predicted_;  // z_{t+1|t}, empty before the first torque  [feature_dim]
  DdmPlanCost cost_;
  Planner planner_;
  std::mt19937_64 rng_;
};

}  // namespace ddm
