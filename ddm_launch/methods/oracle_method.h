// Oracle: the paper's MPC with the true plant as model and with its true state.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/planner.h>
#include <ddm_sim/plant.h>

#include <memory>

namespace ddm {

/// Cost of a plan U from a given state of the plant, with the plant itself as the model:
///
///   J(U) = sum_{k=1}^{K} |p_k - p_goal|^2 + lambda |u_{k-1}|^2
///   state_{k+1} = plant(state_k, u_k)
///
/// p is the position of the moving part in the image, Plant::visiblePosition(). For the pendulum, p
/// lies on a circle, as the features do after training. The planner therefore solves the same
/// problem as with the DDM, but with a perfect model. The gradient is computed backwards through
/// the steps; the Jacobian of each step is computed by central differences.
class OraclePlanCost : public PlanCost {
 public:
  OraclePlanCost(std::unique_ptr<Plant> plant, int horizon, double control_weight);

  /// Sets the goal state.
  void setGoal(const Eigen::VectorXd& state) { goal_ = plant_->visiblePosition(state); }

  /// Sets the state that the plan begins in.
  void setState(const Eigen::VectorXd& state) { states_.col(0) = state; }

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override;
  Eigen::MatrixXd predictedFeatures() const override { return positions_; }
  Eigen::VectorXd goalFeature() const override { return goal_; }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return plant_->torqueDim(); }

 private:
  Eigen::VectorXd next(const Eigen::VectorXd& state, const Eigen::VectorXd& u) const;

  std::unique_ptr<Plant> plant_;  // a copy for predictions, not the controlled plant
  int horizon_;
  double control_weight_;
  Eigen::VectorXd goal_;
  Eigen::MatrixXd states_;     // state_0 ... state_K
  Eigen::MatrixXd positions_;  // p_0 ... p_K
};

}  // namespace ddm
