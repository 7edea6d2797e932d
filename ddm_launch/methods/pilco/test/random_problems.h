// Small random problems, and comparisons of moments and adjoints with samples and differences.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/testing/gradient_check.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "pilco/gp.h"
#include "pilco/moments.h"

namespace ddm::pilco {

inline Eigen::MatrixXd normalMatrix(int rows, int cols, double scale, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, scale);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&]() { return normal(random); });
}

/// A random N(m, s) with correlated entries and standard deviations of about `scale`.
/// @param rank  rank of s
inline Gaussian randomGaussian(int dim, int rank, double scale, std::mt19937_64& random) {
  const Eigen::MatrixXd root = normalMatrix(dim, rank, scale / std::sqrt(rank + 1e-9), random);
  return Gaussian{normalMatrix(dim, 1, 0.5, random), root * root.transpose()};
}

/// A GP on random data with length-scales about 1 and noise standard deviation 0.1.
/// @param uncertain  whether the model contains its uncertainty
inline GpModel randomGp(int dim, int outputs, int n, bool uncertain, std::mt19937_64& random) {
  GpModel model;
  model.inputs = normalMatrix(dim, n, 1.0, random);
  const Eigen::MatrixXd log_scales = normalMatrix(dim, outputs, 0.3, random);
  const Eigen::MatrixXd log_signal = normalMatrix(outputs, 1, 0.3, random);
  model.hyperparameters.resize(dim + 2, outputs);
  model.hyperparameters << log_scales, log_signal.transpose(),
      Eigen::RowVectorXd::Constant(outputs, std::log(0.1));
  model.beta.resize(n, outputs);
  for (int a = 0; a < outputs; ++a) {
    Eigen::MatrixXd A =
        squaredExponential(model.inputs, model.inputs, log_scales.col(a).array().exp().matrix(),
                           std::exp(log_signal(a)));
    A.diagonal().array() += 0.01;
    const Eigen::LLT<Eigen::MatrixXd> llt(A);
    model.beta.col(a) = llt.solve(normalMatrix(n, 1, 1.0, random));
    if (uncertain) model.inverse.push_back(llt.solve(Eigen::MatrixXd::Identity(n, n)));
  }
  return model;
}

/// Draws y_a ~ N(k_a(x)^T beta_a, sf_a^2 - k_a(x)^T A_a^-1 k_a(x)). Without `inverse`, returns the
/// mean.
class GpSampler {
 public:
  GpSampler(GpModel model, std::mt19937_64* random) : model_(std::move(model)), random_(random) {
    const Hyperparameters& log_values = model_.hyperparameters;
    precisions_ = (-2.0 * log_values.topRows(model_.inputDim()).array()).exp();
    signal_variances_ = (2.0 * log_values.row(model_.inputDim()).transpose().array()).exp();
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

/// Symmetric square root, also of a singular s.
inline Eigen::MatrixXd squareRoot(const Eigen::MatrixXd& s) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(s);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

/// Compares predictions of several quantities with sample means, within four standard errors.
/// @param draw  draws all quantities once
inline ::testing::AssertionResult meansMatchSamples(const Eigen::ArrayXd& predicted,
                                                    const std::function<Eigen::ArrayXd()>& draw) {
  constexpr int kSamples = 200000;
  Eigen::ArrayXd sum = 0.0 * predicted, squares = sum;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::ArrayXd values = draw();
    sum += values;
    squares += values.square();
  }
  const Eigen::ArrayXd mean = sum / kSamples;
  const Eigen::ArrayXd variance = (squares / kSamples - mean.square()).max(0.0);
  const Eigen::ArrayXd errors = (mean - predicted).abs() / ((variance / kSamples).sqrt() + 1e-9);
  if ((errors <= 4.0).all()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "off by standard errors: " << errors.transpose();
}

/// Concatenates M, S and cov(x, y) = s V.
inline Eigen::ArrayXd stacked(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                              const Eigen::MatrixXd& cross) {
  Eigen::ArrayXd out(mean.size() + covariance.size() + cross.size());
  out << mean.array(), Eigen::Map<const Eigen::ArrayXd>(covariance.data(), covariance.size()),
      Eigen::Map<const Eigen::ArrayXd>(cross.data(), cross.size());
  return out;
}

/// Compares predicted moments with samples.
inline ::testing::AssertionResult momentsMatchSamples(const Moments& predicted,
                                                      const Gaussian& input, const Sampler& sample,
                                                      std::mt19937_64& random) {
  const Eigen::MatrixXd root = squareRoot(input.covariance);
  std::normal_distribution<double> normal;
  const auto draw = [&] {
    const Eigen::VectorXd dx =
        root * Eigen::VectorXd::NullaryExpr(input.mean.size(), [&] { return normal(random); });
    const Eigen::VectorXd y = sample(input.mean + dx);
    const Eigen::VectorXd dy = y - predicted.mean;
    return stacked(y, dy * dy.transpose(), dx * dy.transpose());
  };
  return meansMatchSamples(
      stacked(predicted.mean, predicted.covariance, input.covariance * predicted.gain), draw);
}

using MomentsMap = std::function<Moments(const Gaussian& input)>;
using MomentsAdjoint = std::function<Gaussian(const Gaussian& input, const Moments& d_output)>;

inline double innerProduct(const Moments& a, const Moments& b) {
  return a.mean.dot(b.mean) + a.covariance.cwiseProduct(b.covariance).sum() +
         a.gain.cwiseProduct(b.gain).sum();
}

/// Random weights of all entries of M, S and V. The weights of S are not symmetric, because an
/// adjoint must not rely on symmetry.
inline Moments randomMoments(int input_dim, int output_dim, std::mt19937_64& random) {
  return Moments{normalMatrix(output_dim, 1, 1.0, random),
                 normalMatrix(output_dim, output_dim, 1.0, random),
                 normalMatrix(input_dim, output_dim, 1.0, random)};
}

/// Concatenates m and all entries of s. The inverse function uses the symmetric part of s.
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

/// Checks dJ/dm and dJ/ds for a random linear function J of all outputs.
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
