// Cost-to-go: value iteration of the learned model over support states of its experience.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <Eigen/Core>
#include <vector>

namespace ddm {

/// V(x), the cost of all later steps under the best torques. A plan needs it where |z - z_ref| misleads: a weak motor has to
/// swing a rod away from the goal before it gets there. A step costs up to 1, as in PILCO (Deisenroth and Rasmussen, ICML
/// 2011),
///
///   stepCost(z) = 1 - exp(-|z - z_ref|^2 / (2 w^2 s^2))
///
/// with the spread s of the support states' features and w = 1/4, and V is the discounted sum of these costs. It is computed
/// for the support states x_i of the model, states that were seen, by predictions of f under each of the torques
/// -max, 0, max of each motor, held for m = 4 steps, and smoothed in between by a kernel (Ormoneit and Sen,
/// Machine Learning 2002, whose averages make the iteration converge):
///
///   V_i = min_u  sum_{j=1..m} gamma^(j-1) stepCost(z_{i,j}) + gamma^m V(x_{i,m})
///   V(x) = (w_0 V_0 + sum_i w_i V_i) / (w_0 + sum_i w_i),   w_i = exp(-|p(x) - p(x_i)|^2 / (2 h^2))
///
/// p(x) = (z_t, z_t - z_{t-1}), both in units of their spread. h is 1.4 times the mean distance between neighbouring support
/// states. V_0 is the value of states farther than 3 h from all of them, where nothing was seen: the goal is never reached
/// from there, V_0 = V_max = 1 / (1 - gamma); or, where epsilon > 0, it is 160 steps away, V_0 = 0.8 V_max. So where no
/// path to the goal is known, plans lead to states that were not seen yet, as in R-max (Brafman and Tennenholtz, JMLR 2002),
/// and where one is known, plans follow it.
class CostToGo {
 public:
  static constexpr int kHoldSteps = 4;    ///< m
  static constexpr double kWidth = 0.25;  ///< w
  /// 3^3 sets of torques for each of up to 1000 support states, each with up to 1000 weights: up to half a
  /// gigabyte, which takes two seconds. One motor more takes three times as much of both.
  static constexpr int kMaxMotors = 3;

  /// @param model       has at least two support states, and at most kMaxMotors motors; outlives this
  /// @param max_torque  of each motor [N m]  [torque_dim]
  /// @pre as above (checked by eigen_assert, i.e. in debug builds only)
  CostToGo(const Ddm& model, const Eigen::VectorXd& max_torque);

  /// Computes V, which takes up to two seconds the first time, when the outcomes of all torques are predicted.
  /// @param z_ref      feature of the goal  [feature_dim]
  /// @param exploring  whether epsilon > 0, see V_0
  void setGoal(const Eigen::VectorXd& z_ref, bool exploring);

  /// @param gradient  out: d stepCost / dz; null: not wanted  [feature_dim]
  double stepCost(const Eigen::Ref<const Eigen::VectorXd>& z, Eigen::VectorXd* gradient) const;

  /// V of the state with the last two features.
  /// @param z         z_t      [feature_dim]
  /// @param before    z_{t-1}  [feature_dim]
  /// @param d_z       out: dV/dz_t, and with it d_before: dV/dz_{t-1}; null: not wanted
  double value(const Eigen::Ref<const Eigen::VectorXd>& z,
               const Eigen::Ref<const Eigen::VectorXd>& before, Eigen::VectorXd* d_z,
               Eigen::VectorXd* d_before) const;

  /// The torques that are compared, one set per column [N m]  [torque_dim x 3^torque_dim]
  const Eigen::MatrixXd& torques() const { return torques_; }

 private:
  /// Where a support state leads to in kHoldSteps under one set of torques.
  struct Outcome {
    Eigen::MatrixXd path;         // features of these steps  [feature_dim x kHoldSteps]
    std::vector<int> neighbours;  // support states near its end
    std::vector<double> weights;  // of these in V; what is missing to 1 is the weight of V_0
  };

  void predictOutcomes();
  Eigen::VectorXd pointOf(const Eigen::Ref<const Eigen::VectorXd>& z,
                          const Eigen::Ref<const Eigen::VectorXd>& before) const;
  Eigen::ArrayXd kernel(const Eigen::VectorXd& point) const;
  Outcome outcomeOf(const Eigen::MatrixXd& path) const;
  double unknownValue() const;
  void iterate(const std::vector<std::vector<double>>& costs);

  const Ddm* model_;
  Eigen::MatrixXd torques_;
  double spread_ = 1.0;         // of the support states' features
  double change_spread_ = 1.0;  // of their changes from one frame to the next
  double h_ = 1.0;              // in units of both
  Eigen::MatrixXd points_;      // p(x_i)  [2 feature_dim x M]
  std::vector<std::vector<Outcome>>
      outcomes_;  // of each support state, one for each set of torques; empty before setGoal()
  Eigen::VectorXd z_ref_;
  bool exploring_ = false;
  Eigen::ArrayXd values_;  // V_i  [M]
};

}  // namespace ddm
