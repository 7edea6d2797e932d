// Cost-to-go: value iteration of the learned model over the support states of its training data.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <Eigen/Core>
#include <vector>

#include "ddm_mpc/saturating_cost.h"

namespace ddm {

/// Cost-to-go V(x): the cost of all later steps under the best torques. Deviation: the paper has no
/// cost-to-go. A plan needs it if |z - z_ref| misleads: a weak motor has to swing a rod away from
/// the goal before it can reach the goal. V is the discounted sum of the SaturatingCost of each
/// step, with the width 1/4.
///
/// Value iteration computes V_i at the support states x_i of the model, which are states of the
/// training data. The prediction model f predicts m = 4 steps from each of them, under each
/// combination of the torques -max, 0 and max of the motors. Between the support states, a kernel
/// interpolates (Ormoneit and Sen, Machine Learning 2002; its averages make the iteration
/// converge):
///
///   V_i = min_u  sum_{j=1..m} gamma^(j-1) cost(z_{i,j}) + gamma^m V(x_{i,m})
///   V(x) = (w_0 V_0 + sum_i w_i V_i) / (w_0 + sum_i w_i)
///   w_i  = exp(-|p(x) - p(x_i)|^2 / (2 h^2))
///
/// where p(x) = (z_t, z_t - z_{t-1}), each part in units of its spread, and h is 1.4 times the mean
/// distance between neighbouring support states. V_0 is the value of unknown states, which are
/// farther than 3 h from all support states:
///  * without exploration, V_0 = V_max = 1 / (1 - gamma): the goal is never reached from there
///  * with exploration (epsilon > 0), V_0 = 0.8 V_max: the goal is 160 steps away
/// With exploration, plans therefore lead to unknown states as long as no path to the goal is known
/// (R-max: Brafman and Tennenholtz, JMLR 2002), and follow a path once it is known.
///
/// The cost of the steps of a plan has a width of its own: half of the root mean square change of
/// the feature in one step, in units of the spread s. With a narrower cost, plans for a plant that
/// moves far in one step do not notice the goal between two images. A wider cost rewards states
/// whose features are merely similar to the goal feature: that of an arm that is folded to the
/// other side may be 0.2 spreads away, and the arm then stays there.
class CostToGo {
 public:
  static constexpr int kHoldSteps = SaturatingCost::kHoldSteps;  ///< m [-]
  /// Width of the cost in V [-]. With a narrower cost, few support states are near enough to the
  /// goal, and V is almost the same everywhere.
  static constexpr double kWidth = 0.25;
  /// Smallest width of the cost of the steps of a plan [-], for plants whose features change slowly.
  static constexpr double kSmallestWidthInPlan = 0.15;

  /// @param model       as for SaturatingCost; must outlive the object
  /// @param max_torque  of each motor [N m]  [torque_dim]
  /// @pre as above (checked by eigen_assert, i.e. in debug builds only)
  CostToGo(const Ddm& model, const Eigen::VectorXd& max_torque);

  /// Computes V for a goal. The first call also predicts the outcomes of all torques, which takes
  /// up to two seconds.
  /// @param z_ref      goal feature         [feature_dim]
  /// @param exploring  whether epsilon > 0; determines V_0
  void setGoal(const Eigen::VectorXd& z_ref, bool exploring);

  /// Evaluates V(x) for a state with these two newest features.
  /// @param z         z_t                                     [feature_dim]
  /// @param before    z_{t-1}                                 [feature_dim]
  /// @param d_z       out: dV/dz_t; null: skip both gradients [feature_dim]
  /// @param d_before  out: dV/dz_{t-1}                        [feature_dim]
  /// @pre setGoal() was called
  double value(const Eigen::Ref<const Eigen::VectorXd>& z,
               const Eigen::Ref<const Eigen::VectorXd>& before, Eigen::VectorXd* d_z,
               Eigen::VectorXd* d_before) const;

  const SaturatingCost& stepCost() const { return step_cost_; }  ///< cost of a step of a plan

 private:
  /// Prediction from a support state under one combination of torques.
  struct Outcome {
    Eigen::MatrixXd path;         // predicted features  [feature_dim x kHoldSteps]
    std::vector<int> neighbours;  // support states near the last of them
    std::vector<double> weights;  // their weights in V; the weight of V_0 is 1 minus their sum
  };

  void predictOutcomes();
  Eigen::VectorXd pointOf(const Eigen::Ref<const Eigen::VectorXd>& z,
                          const Eigen::Ref<const Eigen::VectorXd>& before) const;
  Eigen::ArrayXd kernel(const Eigen::VectorXd& point) const;
  Outcome outcomeOf(const Eigen::MatrixXd& path) const;
  double unknownValue() const;
  void iterate(const std::vector<std::vector<double>>& costs);

  const Ddm* model_;
  SaturatingCost cost_in_v_;  // also knows the torques that value iteration compares
  double change_spread_;      // of the changes z_t - z_{t-1}; infinite if nothing changes
  SaturatingCost step_cost_;
  double h_ = 1.0;          // width of the kernel, in units of both spreads
  Eigen::MatrixXd points_;  // p(x_i)  [2 feature_dim x M]
  // Of each support state, one for each combination of torques. Empty before setGoal().
  std::vector<std::vector<Outcome>> outcomes_;
  bool exploring_ = false;
  Eigen::ArrayXd values_;  // V_i  [M]
};

}  // namespace ddm
