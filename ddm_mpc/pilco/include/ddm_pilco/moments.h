// What every block of PILCO returns for a Gaussian input: mean, covariance and gain of its output.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "ddm_pilco/gp_model.h"
#include "ddm_pilco/messages.h"

namespace ddm::pilco {

/// Moments of y = f(x) for x ~ N(m, s). The same struct holds derivatives of a scalar J in them.
///
/// The gain is s^-1 cov(x, y), that is E[df/dx]^T (Stein's lemma): cov(x, y) = s gain. It stays
/// finite where s is singular or zero, and nothing here ever inverts s.
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

/// x without doubt: the covariance is 0.
inline Gaussian known(const Eigen::VectorXd& x) {
  return {x, Eigen::MatrixXd::Zero(x.size(), x.size())};
}

/// (A + A^T) / 2
inline Eigen::MatrixXd symmetricPart(const Eigen::MatrixXd& A) { return 0.5 * (A + A.transpose()); }

/// @throws std::invalid_argument that starts with `what` unless the matrix has this shape
inline void requireShape(const Eigen::Ref<const Eigen::MatrixXd>& matrix, Eigen::Index rows,
                         Eigen::Index cols, const std::string& what) {
  require(matrix.rows() == rows && matrix.cols() == cols, what, " must be [", rows, " x ", cols,
          "], got [", matrix.rows(), " x ", matrix.cols(), "]");
}

/// @throws std::invalid_argument if the mean is not [dim] or the covariance not [dim x dim]; the
///         message starts with `who`
inline void requireSize(const Gaussian& input, int dim, const std::string& who) {
  requireShape(input.mean, dim, 1, who + ": the mean of the input");
  requireShape(input.covariance, dim, dim, who + ": the covariance of the input");
}

/// The same for derivatives that are handed back to a block.
inline void requireSize(const Moments& d_output, int input_dim, int output_dim,
                        const std::string& who) {
  requireSize(Gaussian{d_output.mean, d_output.covariance}, output_dim, who);
  requireShape(d_output.gain, input_dim, output_dim, who + ": the derivative in the gain");
}

}  // namespace ddm::pilco
