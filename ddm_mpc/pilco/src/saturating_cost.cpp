// Saturating cost: expectation and variance under a Gaussian, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/saturating_cost.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ddm {
namespace pilco {
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
  if (dim < 1 || weight_.rows() != dim || weight_.cols() != dim) {
    throw std::invalid_argument("saturating cost: the weight must be [D x D] for a target of D");
  }
  if (!target_.allFinite() || !weight_.allFinite() ||
      !weight_.isApprox(weight_.transpose(), kRounding)) {
    throw std::invalid_argument("saturating cost: the weight must be finite and symmetric");
  }
}

double SaturatingCost::value(const Eigen::VectorXd& x) const {
  return expected(Gaussian{x, Eigen::MatrixXd::Zero(x.size(), x.size())});
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

}  // namespace pilco
}  // namespace ddm
