// Gaussians and moments, the input and output of all blocks of PILCO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <Eigen/Core>
#include <limits>
#include <stdexcept>
#include <string>

namespace ddm::pilco {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A Gaussian N(mean, covariance).
struct Gaussian {
  Eigen::VectorXd mean;        ///< [D]
  Eigen::MatrixXd covariance;  ///< [D x D]
};

/// Moments of y = f(x) for x ~ N(m, s). The same struct holds the derivatives of a scalar J with
/// respect to these moments.
///
/// The gain is s^-1 cov(x, y), i.e. E[df/dx]^T by Stein's lemma, so that cov(x, y) = s gain. The
/// gain stays finite if s is singular or zero, because no function inverts s.
///
/// eigen_assert checks the sizes of all arguments, i.e. in debug builds only.
struct Moments {
  Eigen::VectorXd mean;        ///< M                          [E]
  Eigen::MatrixXd covariance;  ///< S                      [E x E]
  Eigen::MatrixXd gain;        ///< V = s^-1 cov(x, y)     [D x E]
};

/// Moments or Gaussian with all entries equal to `value`.
inline Moments constantMoments(int input_dim, int output_dim, double value = 0.0) {
  return {Eigen::VectorXd::Constant(output_dim, value),
          Eigen::MatrixXd::Constant(output_dim, output_dim, value),
          Eigen::MatrixXd::Constant(input_dim, output_dim, value)};
}
inline Gaussian constantGaussian(int dim, double value = 0.0) {
  return {Eigen::VectorXd::Constant(dim, value), Eigen::MatrixXd::Constant(dim, dim, value)};
}

/// Mean and covariance of y alone.
inline Gaussian marginal(const Moments& moments) { return {moments.mean, moments.covariance}; }

/// The distribution of a known x: its covariance is 0.
inline Gaussian known(const Eigen::VectorXd& x) {
  return {x, Eigen::MatrixXd::Zero(x.size(), x.size())};
}

/// (A + A^T) / 2
inline Eigen::MatrixXd symmetricPart(const Eigen::MatrixXd& A) { return 0.5 * (A + A.transpose()); }

/// @param ok  condition, written such that NaN makes it false
/// @throws std::invalid_argument with the concatenated parts as message if `ok` is false
template <class... Parts>
void require(bool ok, const Parts&... parts) {
  if (!ok) throw std::invalid_argument(textOf(parts...));
}

}  // namespace ddm::pilco
