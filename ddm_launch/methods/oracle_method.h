// Oracle: the paper's classical MPC, on the true plant and its true state.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/planner.h>
#include <ddm_sim/plant.h>

#include <memory>

namespace ddm {

/// Cost of torques from a state of the plant on, with the plant itself as the model:
///
///   J(U) = sum_{k=1}^{K} |p_k - p_goal|^2 + lambda |u_{k-1}|^2
///   state_{k+1} = plant(state_k, u_k)
///
/// p is where the moving part is in the picture, Plant::visiblePosition(): for the pendulum a
/// circle, as its features are after training, so that the planner meets the same problem with a
/// perfect model. The gradient goes backwards through the steps, each with central differences.
class OraclePlanCost : public PlanCost {
 public:
  OraclePlanCost(std::unique_ptr<Plant> plant, int horizon, double control_weight);

  /// The state to reach.
  void setGoal(const Eigen::VectorXd& state) { goal_ = plant_->visiblePosition(state); }

  /// The state to plan from.
  void setState(const Eigen::VectorXd& state) { state_ = state; }

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override;
  Eigen::MatrixXd predictedFeatures() const override { return positions_; }
  Eigen::VectorXd goalFeature() const override { return goal_; }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return plant_->torqueDim(); }

 private:
  Eigen::VectorXd next(const Eigen::VectorXd& state, const Eigen::VectorXd& u) const;
  void backward(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) const;

  std::unique_ptr<Plant> plant_;  // imagined: never the one that is controlled
  int horizon_;
  double control_weight_;
  Eigen::VectorXd goal_;
  Eigen::VectorXd state_;
  Eigen::MatrixXd states_;     // state_0 ... state_K
  Eigen::MatrixXd positions_;  // p_0 ... p_K
};

}  // namespace ddm
