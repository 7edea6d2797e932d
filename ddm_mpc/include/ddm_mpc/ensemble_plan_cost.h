// Cost J(U) of a plan by several models: their mean, less a bonus for disagreement.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ddm_mpc/plan_cost.h"

namespace ddm {

///   J(U) = mean_i J_i(U) - bonus std_i J_i(U)
///
/// Each model plans in its own feature space. Features and goal are those of the first.
class EnsemblePlanCost : public PlanCost {
 public:
  /// @param costs  of the models, at least one, of one horizon and number of motors; outlive this
  /// @throws std::invalid_argument otherwise
  explicit EnsemblePlanCost(std::vector<PlanCost*> costs);

  /// @param bonus  price of disagreement, >= 0: what the models disagree about is worth a visit
  void setBonus(double bonus) { bonus_ = bonus; }

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override;
  Eigen::MatrixXd predictedFeatures() const override { return costs_[0]->predictedFeatures(); }
  Eigen::VectorXd goalFeature() const override { return costs_[0]->goalFeature(); }
  int horizon() const override { return costs_[0]->horizon(); }
  int torqueDim() const override { return costs_[0]->torqueDim(); }

 private:
  std::vector<PlanCost*> costs_;
  double bonus_ = 0.0;
  std::vector<double> values_;
  std::vector<Eigen::MatrixXd> gradients_;
};

}  // namespace ddm
