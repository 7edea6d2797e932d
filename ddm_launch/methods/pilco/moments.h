// The input and output of every block of PILCO: a Gaussian, and mean, covariance and gain of an output.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm::pilco {

/// A Gaussian N(mean, covariance).
struct Gaussian {
  Eigen::VectorXd mean;        ///< [D]
  Eigen::MatrixXd covariance;  ///< [D x D]
};

/// Moments of y = f(x) for x ~ N(m, s). The same struct holds derivatives of a scalar J in them.
///
/// The gain is s^-1 cov(x, y), that is E[df/dx]^T (Stein's lemma): cov(x, y) = s gain. It stays
/// finite where s is singular or zero, and nothing here ever inverts s.
///
/// Sizes of arguments are checked by eigen_assert, i.e. in debug builds only.
struct Moments {
  Eigen::VectorXd mean;        ///< M                          [E]
  Eigen::MatrixXd covariance;  ///< S                      [E x E]
  Eigen::MatrixXd gain;        ///< V = s^-1 cov(x, y)     [D x E]
};

/// All entries equal to `value`.
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

/// A known x: its covariance is 0.
inline Gaussian known(const Eigen::VectorXd& x) {
  return {x, Eigen::MatrixXd::Zero(x.size(), x.size())};
}

/// (A + A^T) / 2
inline Eigen::MatrixXd symmetricPart(const Eigen::MatrixXd& A) { return 0.5 * (A + A.transpose()); }

/// All parts in one text, as a stream prints them.
template <class... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// @param ok  to be written so that NaN makes it false
/// @throws std::invalid_argument with all parts as its text, unless `ok`
template <class... Parts>
void require(bool ok, const Parts&... parts) {
  if (!ok) throw std::invalid_argument(message(parts...));
}

}  // namespace ddm::pilco
