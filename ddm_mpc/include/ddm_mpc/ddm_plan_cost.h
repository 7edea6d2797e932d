// Cost J(U) of a plan for a deep dynamical model, with its gradient in closed form.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>
#include <ddm_model/roll_out.h>

#include <Eigen/Core>
#include <optional>
#include <variant>
#include <vector>

#include "ddm_mpc/cost_to_go.h"
#include "ddm_mpc/mpc_options.h"
#include "ddm_mpc/planner.h"

namespace ddm {

/// Cost J(U) of a plan (paper, eq. 9), see PlanCost. f predicts its features from the state x_0
/// (eq. 8),
///
///   z_{k+1} = f(z_k, u_k, z_{k-1}, u_{k-1}) + offset
///
/// Deviation: with a SaturatingCost, the cost of a step saturates, and with a CostToGo, the last
/// state has a cost-to-go, too,
///
///   J(U) = sum_{k=1}^{K} (1 - exp(-c_k / (2 w^2))) + V(x_K)
///   c_k  = |z_k - z_ref|^2 / s^2 + lambda (|u_{k-1}|^2 + 10 |u_{k-1} - u_{k-2}|^2) / max_torque^2
///
/// with s and w of the SaturatingCost; without a CostToGo, V = 0. Far from the goal, a step costs 1
/// for every torque; at the goal, a torque raises the cost of the step to at most 1. Changes of torque
/// cost more than torques, because f is not exact: a plan that corrects each error at once alternates
/// between large torques of both signs.
///
/// Deviation: the offset (0 in the paper) corrects each prediction by the error of recent
/// predictions. Offset-free MPC assumes the same error in every step (Pannocchia and Rawlings,
/// AIChE J. 2003).
class DdmPlanCost : public PlanCost {
 public:
  static constexpr double kWidth = 0.5;  ///< w without a CostToGo [-]

  /// std::monostate: eq. (9).
  using Terms = std::variant<std::monostate, SaturatingCost, CostToGo>;

  /// @param model           must outlive the cost
  /// @param horizon         K, at least 1 [-]
  /// @param control_weight  lambda [(N m)^-2]; with a SaturatingCost or a CostToGo [-]
  /// @param terms           what J(U) consists of
  DdmPlanCost(const Ddm& model, int horizon, double control_weight, Terms terms = {});

  /// Sets the goal. If goal_feature or exploring has changed, computes the cost-to-go, which takes
  /// up to two seconds. setProblem() sets the goal, too.
  /// @param goal_feature  z_ref  [feature_dim]
  /// @param exploring     whether epsilon > 0, see CostToGo
  void setGoal(const Eigen::VectorXd& goal_feature, bool exploring);

  /// Sets the current state, the goal and the offset of the next plans.
  /// @param x             controller state, not empty
  /// @param goal_feature  z_ref                                     [feature_dim]
  /// @param offset        added to each predicted feature           [feature_dim]
  /// @pre as above, and all sizes are those of the model (checked by eigen_assert)
  void setProblem(const History& x, const Eigen::VectorXd& goal_feature,
                  const Eigen::VectorXd& offset);
  /// Sets the current state and the goal, with offset 0.
  void setProblem(const History& x, const Eigen::VectorXd& goal_feature) {
    setProblem(x, goal_feature, Eigen::VectorXd::Zero(f_.featureDim()));
  }

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override;
  /// Proposes a plan by a beam search over the torques of SaturatingCost, each held for its
  /// kHoldSteps steps. With a CostToGo, only the best plan is continued after each decision, because
  /// V tells where the plan leads. Without a CostToGo, the best 9^torque_dim plans are continued,
  /// which is the number of plans with two decisions, because no plan may come near the goal before
  /// the last decision. If all plans are continued, two models of the cart-pole return 864 and 863
  /// instead of 861 and 863, and planning takes a half longer. Empty with eq. (9).
  std::optional<Eigen::MatrixXd> proposal() override;
  Eigen::MatrixXd predictedFeatures() const override;
  Eigen::VectorXd goalFeature() const override { return goal_feature_; }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return f_.torqueDim(); }

 private:
  struct HeldPlan {
    Eigen::MatrixXd torques;   // like torques_
    Eigen::MatrixXd features;  // the newest n features after the plan, like features_
    double cost;               // sum of its steps' costs
    double total;              // with the cost-to-go
  };

  const SaturatingCost* saturatingCost() const;
  std::vector<HeldPlan> continued(const std::vector<HeldPlan>& plans, int begin, int num_steps);
  void rollOut(const Eigen::Ref<const Eigen::MatrixXd>& U, int num_steps);
  Eigen::VectorXd featureAfter(int num_steps) const;
  double stepCost(const Eigen::Ref<const Eigen::VectorXd>& z, const Eigen::MatrixXd& torques,
                  Eigen::Index column, Eigen::VectorXd* d_z, Eigen::MatrixXd* d_torques) const;

  const PredictionModel<double>& f_;
  const double* theta_p_;
  int horizon_ = 0;
  Eigen::ArrayXd control_weight_;  // factor of each motor's squared torque [(N m)^-2]
  Terms terms_;
  bool exploring_ = false;
  Eigen::VectorXd goal_feature_;
  Eigen::VectorXd offset_;
  RollOut<double> roll_out_;
  RollOut<double> search_;     // of the plans that proposal() compares
  Eigen::MatrixXd features_;   // z_{-n+1} ... z_0                            [feature_dim x n]
  Eigen::MatrixXd torques_;    // u_{-n+1} ... u_{K-1} [N m]        [torque_dim x (n - 1 + K)]
  Eigen::MatrixXd d_torques_;  // dJ/d torques_ [1/(N m)]
  Eigen::VectorXd d_step_;     // d stepCost / dz                           [feature_dim]
};

/// Makes the cost that mpc/cost selects.
/// @param model  must outlive the cost
/// @throws std::invalid_argument if max_torque exceeds that of the model or has a wrong number of
///         entries. With mpc/cost saturating or time, also if the model has fewer than two support
///         states or more than SaturatingCost::kMaxMotors motors
DdmPlanCost makePlanCost(const Ddm& model, const MpcOptions& options);

}  // namespace ddm
