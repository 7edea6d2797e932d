// What every block of PILCO returns for a Gaussian input: mean, covariance and gain of its output.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/gp_model.h"

namespace ddm {
namespace pilco {

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
Moments constantMoments(int input_dim, int output_dim, double value = 0.0);
Gaussian constantGaussian(int dim, double value = 0.0);

/// (A + A^T) / 2
Eigen::MatrixXd symmetricPart(const Eigen::MatrixXd& A);

/// @throws std::invalid_argument if the mean is not [dim] or the covariance not [dim x dim]; the
///         message starts with `who`
void requireSize(const Gaussian& input, int dim, const char* who);

/// The same for derivatives that are handed back to a block.
void requireSize(const Moments& d_output, int input_dim, int output_dim, const char* who);

}  // namespace pilco
}  // namespace ddm
