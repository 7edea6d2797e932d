// Cost J(U) of a plan by a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>
#include <ddm_model/roll_out.h>

#include <Eigen/Core>
#include <optional>

#include "ddm_mpc/cost_to_go.h"
#include "ddm_mpc/mpc_options.h"
#include "ddm_mpc/planner.h"

namespace ddm {

/// J(U) of eq. (9), with features as f predicts them from the current state x_0 (eq. 8) on:
///
///   z_{k+1} = f(z_k, u_k, z_{k-1}, u_{k-1}) + offset
///
/// or, with a CostToGo, by costs of a step that saturate, and the cost-to-go of the last state:
///
///   J(U) = sum_{k=1}^{K} [1 - exp(-(|z_k - z_ref|^2 / s^2 + lambda |u_{k-1} / max_torque|^2) / (2 w^2))] + V(x_K)
///
/// with the s and w of CostToGo. A step far from the goal costs 1 whatever its torque; at the goal, torque makes it cost up
/// to 1.
///
/// The offset is the error of recent predictions (0 in the paper): the same error in every step, as offset-free model
/// predictive control assumes it (Pannocchia and Rawlings, AIChE J. 2003).
class DdmPlanCost : public PlanCost {
 public:
  /// @param model           outlives the cost
  /// @param horizon         K >= 1, steps
  /// @param control_weight  lambda [(N m)^-2], with a CostToGo [-]: of a torque of max_torque
  DdmPlanCost(const Ddm& model, int horizon, double control_weight,
              std::optional<CostToGo> cost_to_go = std::nullopt);

  /// The feature to plan to, and whether epsilon > 0, which is for the CostToGo. If one has changed, computes the
  /// cost-to-go, which takes up to two seconds. setProblem() does so too.
  void setGoal(const Eigen::VectorXd& goal_feature, bool exploring);

  /// The state to plan from, the feature to plan to, and the offset.
  /// @pre the history is not empty, and all sizes are those of the model (checked by eigen_assert)
  void setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                  const Eigen::VectorXd& offset);
  /// The same without an offset.
  void setProblem(const History& x, const Eigen::VectorXd& goal_feature) {
    setProblem(x, goal_feature, Eigen::VectorXd::Zero(f_.featureDim()));
  }

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override;
  /// Of the torques that CostToGo compares, those that are best for its next steps, then for those
  /// after them, and so on. Empty without a CostToGo.
  std::optional<Eigen::MatrixXd> proposal() override;
  Eigen::MatrixXd predictedFeatures() const override;
  Eigen::VectorXd goalFeature() const override { return goal_feature_; }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return f_.torqueDim(); }

 private:
  void rollOut(const Eigen::Ref<const Eigen::MatrixXd>& U, int num_steps);
  Eigen::VectorXd featureAfter(int num_steps) const;
  double stepCost(int step, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* d_z,
                  Eigen::VectorXd* d_u) const;

  const PredictionModel<double>& f_;
  const double* theta_p_;
  int horizon_ = 0;
  Eigen::ArrayXd control_weight_;  // of a squared torque, by motor [(N m)^-2]
  std::optional<CostToGo> cost_to_go_;
  bool exploring_ = false;
  Eigen::VectorXd goal_feature_;
  Eigen::VectorXd offset_;
  RollOut<double> roll_out_;
  Eigen::MatrixXd features_;   // z_{-n-d+1} ... z_0                    [feature_dim x (n + d)]
  Eigen::MatrixXd torques_;    // u_{-n-d+1} ... u_{K-1} [N m]  [torque_dim x (n + d - 1 + K)]
  Eigen::MatrixXd d_torques_;  // dJ/du of these
  Eigen::VectorXd d_step_;     // d stepCost / dz                           [feature_dim]
  Eigen::VectorXd d_torque_;   // d stepCost / du                           [torque_dim]
};

/// The cost that the options ask for.
/// @param model  outlives the cost
/// @throws std::invalid_argument if max_torque exceeds the model's or is for another number of motors; with mpc/cost time
///         also if the model has fewer than two support states, or more motors than CostToGo takes
DdmPlanCost makePlanCost(const Ddm& model, const MpcOptions& options);

}  // namespace ddm
