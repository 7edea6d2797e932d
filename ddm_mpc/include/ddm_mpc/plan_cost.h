// Cost J(U) of a plan: what the planner minimises.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace ddm {

/// Cost of the torques u_0 ... u_{K-1} from a current state on, which the implementation holds. With
/// `mpc/cost: distance`
///
///   J(U) = sum_{k=1}^{K} |z_k - z_ref|^2 + lambda |u_{k-1}|^2
///
/// and DdmPlanCost has another. Implementations differ in whose predictions z_k are: eq. (7) of the paper plans with a known
/// model of the state, eq. (9) in feature space. Deviation: the paper's sum runs over z_0 ...
/// z_{K-1}, in which z_0 is a constant and u_{K-1} acts on nothing; here it runs over the K
/// features that the K torques bring about.
class PlanCost {
 public:
  virtual ~PlanCost() = default;

  /// @param U    torques [N m]                            [torqueDim() x horizon()]
  /// @param d_U  out: dJ/dU; null: not wanted [1/(N m)]   [torqueDim() x horizon()]
  /// @return     J(U)
  virtual double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) = 0;

  /// Torques that are worth starting a search from; nothing where none are known [N m]
  virtual std::optional<Eigen::MatrixXd> proposal() { return std::nullopt; }

  /// z_0 and the features predicted in the last evaluate()  [feature_dim x (K + 1)]
  virtual Eigen::MatrixXd predictedFeatures() const = 0;

  virtual Eigen::VectorXd goalFeature() const = 0;  ///< z_ref  [feature_dim]
  virtual int horizon() const = 0;                  ///< K, steps
  virtual int torqueDim() const = 0;
};

}  // namespace ddm
