// Draws function values of a GP at a known input: the definition that moment matching integrates.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "ddm_pilco/gp_model.h"

namespace ddm {
namespace pilco {

/// y_a ~ N(k_a(x)^T beta_a, sf_a^2 - k_a(x)^T A_a^-1 k_a(x)); without `inverse` the mean alone.
class GpSampler {
 public:
  GpSampler(GpModel model, std::mt19937_64* random) : model_(std::move(model)), random_(random) {
    precisions_ = (-2.0 * model_.hyperparameters.log_length_scales.array()).exp();
    signal_variances_ = (2.0 * model_.hyperparameters.log_signal_std.array()).exp();
  }

  Eigen::VectorXd operator()(const Eigen::VectorXd& x) {
    const Eigen::MatrixXd squares = (model_.inputs.colwise() - x).array().square();
    Eigen::VectorXd y(model_.outputDim());
    for (int a = 0; a < model_.outputDim(); ++a) {
      const Eigen::VectorXd k =
          signal_variances_[a] * (-0.5 * (squares.transpose() * precisions_.col(a)).array()).exp();
      y[a] = k.dot(model_.beta.col(a));
      if (!model_.inverse.empty()) {
        const double variance = signal_variances_[a] - k.dot(model_.inverse[a] * k);
        y[a] += std::sqrt(std::max(0.0, variance)) * normal_(*random_);
      }
    }
    return y;
  }

 private:
  GpModel model_;
  std::mt19937_64* random_;
  std::normal_distribution<double> normal_;
  Eigen::MatrixXd precisions_;
  Eigen::VectorXd signal_variances_;
};

}  // namespace pilco
}  // namespace ddm
