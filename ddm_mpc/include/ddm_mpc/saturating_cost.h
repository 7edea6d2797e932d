// Saturating cost of a step, for plants whose way to the goal first leads away from it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>

#include <Eigen/Core>

namespace ddm {

/// Cost of a step that is at most 1, as in PILCO (Deisenroth and Rasmussen, ICML 2011):
///
///   cost(z) = 1 - exp(-|z - z_ref|^2 / (2 w^2 s^2))
///
/// with a width w and the spread s, which is the root mean square distance of the features of the
/// model's support states from their mean. Deviation: the paper has |z - z_ref|^2 (eq. 9). The class
/// also knows the torques that searches for a plan compare.
class SaturatingCost {
 public:
  /// Searches compare 3^motors combinations of torques. For three motors, CostToGo has 3^3
  /// combinations for each of up to 1000 support states, each with up to 1000 weights: up to half a
  /// gigabyte and two seconds. Each further motor triples both.
  static constexpr int kMaxMotors = 3;
  static constexpr int kHoldSteps = 4;  ///< steps for which searches hold torques [-]

  /// @param model       has at least two support states and at most kMaxMotors motors
  /// @param max_torque  of each motor [N m]  [torque_dim]
  /// @param width       w [-]
  /// @pre as above (checked by eigen_assert, i.e. in debug builds only)
  SaturatingCost(const Ddm& model, const Eigen::VectorXd& max_torque, double width);

  /// @param z_ref  goal feature  [feature_dim]
  void setGoal(const Eigen::VectorXd& z_ref) { z_ref_ = z_ref; }

  /// @param z         feature                             [feature_dim]
  /// @param gradient  out: d cost / dz; null: skip        [feature_dim]
  /// @pre setGoal() was called
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& z, Eigen::VectorXd* gradient) const;

  double spread() const { return spread_; }  ///< s
  double width() const { return width_; }    ///< w [-]
  /// @return all combinations of the torques -max, 0 and max of the motors, one per column [N m]
  ///         [torque_dim x 3^torque_dim]
  const Eigen::MatrixXd& torques() const { return torques_; }

 private:
  Eigen::MatrixXd torques_;
  double width_;
  double spread_;
  Eigen::VectorXd z_ref_;
};

}  // namespace ddm
