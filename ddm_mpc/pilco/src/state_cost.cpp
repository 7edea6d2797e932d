// Saturating cost, and the cost of a state: that of its features.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/state_cost.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "ddm_pilco/messages.h"

namespace ddm::pilco {
namespace {

constexpr double kRounding = 1e-12;

/// E[exp(-k/2 (x - z)^T W (x - z))], and P_k = W (I + k s W)^-1.
double expectedReward(const Gaussian& input, const Eigen::VectorXd& target,
                      const Eigen::MatrixXd& weight, double k, Eigen::MatrixXd* precision) {
  const Eigen::Index dim = target.size();
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(Eigen::MatrixXd::Identity(dim, dim) +
                                                k * weight * s);
  *precision = symmetricPart(lu.solve(weight));
  const Eigen::VectorXd d = input.mean - target;
  return std::exp(-0.5 * k * d.dot(*precision * d)) / std::sqrt(lu.determinant());
}

}  // namespace

SaturatingCost::SaturatingCost(Eigen::VectorXd target, const Eigen::MatrixXd& weight)
    : target_(std::move(target)), weight_(weight) {
  const Eigen::Index dim = target_.size();
  require(dim >= 1, "saturating cost: a target is missing");
  requireShape(weight_, dim, dim, "saturating cost: the weight");
  require(target_.allFinite() && weight_.allFinite() &&
              weight_.isApprox(weight_.transpose(), kRounding),
          "saturating cost: the weight must be finite and symmetric");
}

/// dE[c]/dm = r P d,  dE[c]/ds = r (P - P d d^T P) / 2,  with r = 1 - E[c], d = m - z.
double SaturatingCost::expected(const Gaussian& input, Gaussian* d_input) const {
  requireSize(input, inputDim(), "saturating cost");
  Eigen::MatrixXd P;
  const double reward = expectedReward(input, target_, weight_, 1.0, &P);
  if (d_input != nullptr) {
    const Eigen::VectorXd P_d = P * (input.mean - target_);
    d_input->mean = reward * P_d;
    d_input->covariance = 0.5 * reward * (P - P_d * P_d.transpose());
  }
  return 1.0 - reward;
}

double SaturatingCost::variance(const Gaussian& input) const {
  requireSize(input, inputDim(), "saturating cost");
  Eigen::MatrixXd P;
  const double reward = expectedReward(input, target_, weight_, 1.0, &P);
  const double squared = expectedReward(input, target_, weight_, 2.0, &P);
  const double variance = squared - reward * reward;
  return variance < kRounding ? 0.0 : variance;
}

StateCost::StateCost(Augmentation features, SaturatingCost cost)
    : features_(std::move(features)), cost_(std::move(cost)) {
  require(features_.outputDim() == cost_.inputDim(),
          "state cost: the target must have the size of the features");
}

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
  require(length > 0.0 && width > 0.0, "pendulum cost: length and width must be positive");
  const double weight = length * length / (width * width);
  return StateCost(
      Augmentation(2, {}, {1}),
      SaturatingCost(Eigen::Vector2d(0.0, -1.0), weight * Eigen::MatrixXd::Identity(2, 2)));
}

}  // namespace ddm::pilco
