// Sums of n x n weighted exponentials: nearly all the time of PILCO is spent here.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ddm::pilco {

/// The matrix P_ij = w_ij c_j exp(f_i + g_j + u_i^T v_j) of n x n numbers, which is never stored.
struct ExponentialMatrix {
  Eigen::VectorXd f;               ///<                                      [n]
  Eigen::VectorXd g;               ///<                                      [n]
  Eigen::MatrixXd u;               ///< u_i in rows                      [n x D]
  Eigen::MatrixXd v;               ///< v_j in columns                   [D x n]
  Eigen::VectorXd column_weights;  ///< c                                    [n]
};

struct ExponentialSums {
  Eigen::VectorXd rows;     ///< sum_j P_ij                                  [n]
  Eigen::VectorXd columns;  ///< sum_i P_ij                                  [n]
  Eigen::MatrixXd moments;  ///< sum_i P_ij u_i in columns               [D x n]
};

/// The exponent is clamped to [-500, 709]: e^-500 is nothing, and less could make products denormal,
/// for which a processor takes a hundred times as long. All entries must be finite.
/// @param w  one column: it is the same for all. n columns: above the diagonal it is taken for 0
///                                                                 [n x 1 or n x n]
/// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
void exponentialSums(const ExponentialMatrix& matrix, const Eigen::Ref<const Eigen::MatrixXd>& w,
                     ExponentialSums* sums);

}  // namespace ddm::pilco
