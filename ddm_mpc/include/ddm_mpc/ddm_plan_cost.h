// Cost J(U) of a plan in feature space, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>

#include <Eigen/Core>
#include <vector>

namespace ddm {

/// Cost of torques from the current state x_0 on (paper, Sec. 3.1):
///
///   J(U) = sum_{k=1}^{K} |z_k - z_ref|^2 + lambda |u_{k-1}|^2,   z_{k+1} = f(z_k, u_k, z_{k-1},
///   u_{k-1})
///
/// Deviation: the paper's sum runs over z_0 ... z_{K-1}, in which z_0 is a constant and u_{K-1}
/// acts on nothing; here it runs over the K features that the K torques bring about.
class PlanCost {
 public:
  /// @param model           outlives the cost
  /// @param horizon         K, steps
  /// @param control_weight  lambda [(N m)^-2]
  PlanCost(const Ddm& model, int horizon, double control_weight);

  /// The state to plan from and the feature to plan to.
  /// @throws std::invalid_argument for a wrong size or an empty history
  void setProblem(const History& x, const Eigen::VectorXd& goal_feature);

  /// @param U    torques [N m]                        [torque_dim x K]
  /// @param d_U  out: dJ/dU; null: not wanted [1/(N m)]   [torque_dim x K]
  /// @return     J(U)
  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U);

  /// z_0 and the features predicted in the last evaluate()  [feature_dim x (K + 1)]
  Eigen::MatrixXd predictedFeatures() const;

  int horizon() const { return horizon_; }
  int torqueDim() const { return f_.torqueDim(); }

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
