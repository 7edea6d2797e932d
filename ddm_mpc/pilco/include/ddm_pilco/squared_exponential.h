// Squared-exponential covariance with one length-scale for each input (ARD).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ddm {
namespace pilco {

/// k(a, b) = signal_std^2 exp(-1/2 sum_d ((a_d - b_d) / length_scales_d)^2) of all pairs.
///
/// The differences are formed before they are squared: |a|^2 - 2 a b + |b|^2 would lose half of the
/// digits where points lie close together.
/// @param a              one input per column                                        [D x n_a]
/// @param b              one input per column                                        [D x n_b]
/// @param length_scales  in units of the inputs                                            [D]
/// @param signal_std     in units of the output
/// @return               row i, column j: k(a_i, b_j)                              [n_a x n_b]
/// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
Eigen::MatrixXd squaredExponential(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                   const Eigen::VectorXd& length_scales, double signal_std);

}  // namespace pilco
}  // namespace ddm
