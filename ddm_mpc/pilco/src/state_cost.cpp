// Cost of a state: saturating cost of its features.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/state_cost.h"

#include <stdexcept>
#include <utility>

namespace ddm {
namespace pilco {
namespace {

Gaussian marginal(const Moments& features) { return Gaussian{features.mean, features.covariance}; }

}  // namespace

StateCost::StateCost(Augmentation features, SaturatingCost cost)
    : features_(std::move(features)), cost_(std::move(cost)) {
  if (features_.outputDim() != cost_.inputDim()) {
    throw std::invalid_argument("state cost: the target must have the size of the features");
  }
}

double StateCost::value(const Eigen::VectorXd& x) const { return cost_.value(features_.value(x)); }

double StateCost::expected(const Gaussian& state, Gaussian* d_state) const {
  const Gaussian features = marginal(features_.predict(state));
  if (d_state == nullptr) return cost_.expected(features);
  Gaussian d_features;
  const double expected = cost_.expected(features, &d_features);
  *d_state = features_.backward(
      state, Moments{d_features.mean, d_features.covariance,
                     Eigen::MatrixXd::Zero(features_.inputDim(), features_.outputDim())});
  return expected;
}

double StateCost::variance(const Gaussian& state) const {
  return cost_.variance(marginal(features_.predict(state)));
}

StateCost pendulumCost(double length, double width) {
  if (!(length > 0.0) || !(width > 0.0)) {
    throw std::invalid_argument("pendulum cost: length and width must be positive");
  }
  const double weight = length * length / (width * width);
  return StateCost(
      Augmentation(2, {}, {1}),
      SaturatingCost(Eigen::Vector2d(0.0, -1.0), weight * Eigen::MatrixXd::Identity(2, 2)));
}

}  // namespace pilco
}  // namespace ddm
