// Small random problems for the tests: Gaussians and GPs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <random>

#include "ddm_pilco/gp_model.h"

namespace ddm {
namespace pilco {

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

}  // namespace pilco
}  // namespace ddm
