// Small random problems for the tests, and what must hold for moments and their adjoints.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/testing/gradient_check.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "ddm_pilco/gp.h"
#include "ddm_pilco/moments.h"

namespace ddm::pilco {

inline Eigen::MatrixXd normalMatrix(int rows, int cols, double scale, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, scale);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&]() { return normal(random); });
}

/// N(m, s) with standard deviations of about `scale` and correlations.
/// @param rank  of s
inline Gaussian randomGaussian(int dim, int rank, double scale, std::mt19937_64& random) {
  const Eigen::MatrixXd root = normalMatrix(dim, rank, scale / std::sqrt(rank + 1e-9), random);
  return Gaussian{normalMatrix(dim, 1, 0.5, random), root * root.transpose()};
}

/// A GP on random data, length-scales about 1, noise standard deviation 0.1.
/// @param uncertain  whether it knows its model uncertainty
inline GpModel randomGp(int dim, int outputs, int n, bool uncertain, std::mt19937_64& random) {
  GpModel model;
  model.inputs = normalMatrix(dim, n, 1.0, random);
  model.hyperparameters.log_length_scales = normalMatrix(dim, outputs, 0.3, random);
  model.hyperparameters.log_signal_std = normalMatrix(outputs, 1, 0.3, random);
  model.hyperparameters.log_noise_std = Eigen::VectorXd::Constant(outputs, std::log(0.1));
  model.beta.resize(n, outputs);
  for (int a = 0; a < outputs; ++a) {
    const Eigen::VectorXd scales = model.hyperparameters.log_length_scales.col(a).array().exp();
    Eigen::MatrixXd A = squaredExponential(model.inputs, model.inputs, scales,
                                           std::exp(model.hyperparameters.log_signal_std[a]));
    A.diagonal().array() += 0.01;
    const Eigen::LLT<Eigen::MatrixXd> llt(A);
    model.beta.col(a) = llt.solve(normalMatrix(n, 1, 1.0, random));
    if (uncertain) model.inverse.push_back(llt.solve(Eigen::MatrixXd::Identity(n, n)));
  }
  return model;
}

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
  constexpr int kSamples = 200000;
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

using MomentsMap = std::function<Moments(const Gaussian& input)>;
using MomentsAdjoint = std::function<Gaussian(const Gaussian& input, const Moments& d_output)>;

inline double innerProduct(const Moments& a, const Moments& b) {
  return a.mean.dot(b.mean) + a.covariance.cwiseProduct(b.covariance).sum() +
         a.gain.cwiseProduct(b.gain).sum();
}

/// Weights of all entries of M, S and V. Those of S are not symmetric: an adjoint must not rely on
/// that.
inline Moments randomMoments(int input_dim, int output_dim, std::mt19937_64& random) {
  return Moments{normalMatrix(output_dim, 1, 1.0, random),
                 normalMatrix(output_dim, output_dim, 1.0, random),
                 normalMatrix(input_dim, output_dim, 1.0, random)};
}

/// m and all entries of s one after the other; s is read as the symmetric part.
inline Eigen::VectorXd flatten(const Gaussian& gaussian) {
  Eigen::VectorXd flat(gaussian.mean.size() + gaussian.covariance.size());
  flat << gaussian.mean,
      Eigen::Map<const Eigen::VectorXd>(gaussian.covariance.data(), gaussian.covariance.size());
  return flat;
}

inline Gaussian unflatten(const Eigen::VectorXd& flat, int dim) {
  return Gaussian{flat.head(dim),
                  symmetricPart(Eigen::Map<const Eigen::MatrixXd>(flat.data() + dim, dim, dim))};
}

/// Checks dJ/dm and dJ/ds for a random linear J of all outputs.
inline ::testing::AssertionResult adjointMatches(const MomentsMap& map,
                                                 const MomentsAdjoint& adjoint,
                                                 const Gaussian& input, std::mt19937_64& random) {
  const int dim = static_cast<int>(input.mean.size());
  const Moments weights = randomMoments(dim, static_cast<int>(map(input).mean.size()), random);
  const auto J = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Gaussian at = unflatten(x, dim);
    if (gradient != nullptr) *gradient = flatten(adjoint(at, weights));
    return innerProduct(map(at), weights);
  };
  return ddm::testing::gradientMatches(J, flatten(input));
}

}  // namespace ddm::pilco
