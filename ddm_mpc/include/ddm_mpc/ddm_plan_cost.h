// Cost J(U) of a plan by a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>

#include <Eigen/Core>
#include <vector>

#include "ddm_mpc/plan_cost.h"

namespace ddm {

/// Features as f predicts them from the current state x_0 on (paper, Sec. 3.1):
///
///   z_{k+1} = f(z_k, u_k, z_{k-1}, u_{k-1})
class DdmPlanCost : public PlanCost {
 public:
  /// @param model           outlives the cost
  /// @param horizon         K, steps
  /// @param control_weight  lambda [(N m)^-2]
  DdmPlanCost(const Ddm& model, int horizon, double control_weight);

  /// The state to plan from and the feature to plan to.
  /// @throws std::invalid_argument for a wrong size or an empty history
  void setProblem(const History& x, const Eigen::VectorXd& goal_feature);

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override;
  Eigen::MatrixXd predictedFeatures() const override;
  Eigen::VectorXd goalFeature() const override { return goal_feature_; }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return f_.torqueDim(); }

 private:
  void fillRegressor(int step, const Eigen::Ref<const Eigen::MatrixXd>& U);

  const PredictionModel<double>& f_;
  const double* theta_p_;
  int horizon_;
  double control_weight_;
  double max_torque_;
  int order_;
  Eigen::VectorXd goal_feature_;
  Eigen::MatrixXd past_torques_;  // u_{-1}, u_{-2}, ... in units of max_torque
  Eigen::MatrixXd features_;      // z_{-n+1} ... z_K; z_0 stands in column n - 1
  Eigen::MatrixXd d_features_;
  Eigen::VectorXd regressor_;
  Eigen::MatrixXd d_regressor_;
  std::vector<Mlp<double>::Tape> tapes_;  // one per step
};

}  // namespace ddm
