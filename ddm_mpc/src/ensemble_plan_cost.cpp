// Cost J(U) of a plan by several models: their mean, less a bonus for disagreement.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ensemble_plan_cost.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace ddm {

EnsemblePlanCost::EnsemblePlanCost(std::vector<PlanCost*> costs)
    : costs_(std::move(costs)), values_(costs_.size()), gradients_(costs_.size()) {
  if (costs_.empty()) throw std::invalid_argument("ensemble: there must be a model");
  for (const PlanCost* cost : costs_) {
    if (cost->horizon() != horizon() || cost->torqueDim() != torqueDim()) {
      throw std::invalid_argument("ensemble: horizons or torques of its models do not fit");
    }
  }
}

double EnsemblePlanCost::evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U,
                                  Eigen::MatrixXd* d_U) {
  const size_t count = costs_.size();
  double sum = 0.0;
  for (size_t i = 0; i < count; ++i) {
    values_[i] = costs_[i]->evaluate(U, d_U != nullptr ? &gradients_[i] : nullptr);
    sum += values_[i];
  }
  const double mean = sum / static_cast<double>(count);
  double variance = 0.0;
  for (const double value : values_) variance += (value - mean) * (value - mean);
  const double spread = std::sqrt(variance / static_cast<double>(count));
  if (d_U != nullptr) {
    d_U->setZero(U.rows(), U.cols());
    for (size_t i = 0; i < count; ++i) {
      // Where all agree the spread has a kink: no direction is better than another.
      const double by_spread = spread > 0.0 ? (values_[i] - mean) / spread : 0.0;
      *d_U += (1.0 - bonus_ * by_spread) / static_cast<double>(count) * gradients_[i];
    }
  }
  return mean - bonus_ * spread;
}

}  // namespace ddm
