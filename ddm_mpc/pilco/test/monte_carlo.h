// Compares predicted moments with a million samples.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "ddm_pilco/moments.h"

namespace ddm {
namespace pilco {

/// Draws y for a given x.
using Sampler = std::function<Eigen::VectorXd(const Eigen::VectorXd& x)>;

/// Symmetric square root: also for an s that is singular.
inline Eigen::MatrixXd squareRoot(const Eigen::MatrixXd& s) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(s);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Sample mean of a quantity against its prediction.
class SampleMean {
 public:
  void add(double value) {
    sum_ += value;
    sum_squares_ += value * value;
    ++count_;
  }
  /// Distance in standard errors of the mean. Rounding counts as a standard error of 1e-9.
  double deviation(double predicted) const {
    const double mean = sum_ / count_;
    const double variance = std::max(0.0, sum_squares_ / count_ - mean * mean);
    const double error = std::abs(mean - predicted) / (std::sqrt(variance / count_) + 1e-9);
    return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
  }

 private:
  double sum_ = 0.0;
  double sum_squares_ = 0.0;
  double count_ = 0.0;
};

/// M, S and cov(x, y) = s V against samples; each entry within four standard errors. An empty gain
/// is not compared.
inline ::testing::AssertionResult momentsMatchSamples(const Moments& predicted,
                                                      const Gaussian& input, const Sampler& sample,
                                                      std::mt19937_64& random) {
  constexpr int kSamples = 1000000;
  const Eigen::Index dim = input.mean.size();
  const Eigen::Index outputs = predicted.mean.size();
  const bool with_cross = predicted.gain.size() > 0;
  const Eigen::MatrixXd cross =
      with_cross ? Eigen::MatrixXd(input.covariance * predicted.gain) : Eigen::MatrixXd();
  const Eigen::MatrixXd root = squareRoot(input.covariance);
  std::vector<SampleMean> means(outputs), products(outputs * outputs), crosses(dim * outputs);
  std::normal_distribution<double> normal;
  Eigen::VectorXd unit(dim);
  for (int i = 0; i < kSamples; ++i) {
    for (Eigen::Index d = 0; d < dim; ++d) unit[d] = normal(random);
    const Eigen::VectorXd dx = root * unit;
    const Eigen::VectorXd y = sample(input.mean + dx);
    const Eigen::VectorXd dy = y - predicted.mean;
    for (Eigen::Index a = 0; a < outputs; ++a) {
      means[a].add(y[a]);
      for (Eigen::Index b = 0; b < outputs; ++b) products[a * outputs + b].add(dy[a] * dy[b]);
      for (Eigen::Index d = 0; d < dim; ++d) crosses[a * dim + d].add(dx[d] * dy[a]);
    }
  }
  double worst = 0.0;
  std::string at;
  const auto consider = [&](double deviation, const std::string& name) {
    if (deviation > worst) {
      worst = deviation;
      at = name;
    }
  };
  for (Eigen::Index a = 0; a < outputs; ++a) {
    const std::string output = std::to_string(a);
    consider(means[a].deviation(predicted.mean[a]), "M " + output);
    for (Eigen::Index b = 0; b < outputs; ++b) {
      consider(products[a * outputs + b].deviation(predicted.covariance(a, b)),
               "S " + output + " " + std::to_string(b));
    }
    for (Eigen::Index d = 0; with_cross && d < dim; ++d) {
      consider(crosses[a * dim + d].deviation(cross(d, a)),
               "s V " + std::to_string(d) + " " + output);
    }
  }
  if (worst <= 4.0) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << at << " is " << worst << " standard errors off";
}

}  // namespace pilco
}  // namespace ddm
