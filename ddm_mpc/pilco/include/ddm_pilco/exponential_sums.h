// Sums of n x n weighted exponentials: nearly all the time of PILCO is spent here.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ddm::pilco {

/// The matrix P_ij = w_ij c_j exp(f_i + g_j + u_i^T v_j) of n x n numbers, which is never stored.
struct ExponentialMatrix {
  Eigen::VectorXd f;                ///<                                     [n]
  Eigen::VectorXd g;                ///<                                     [n]
  Eigen::MatrixXd u;                ///< u_i in rows                     [n x D]
  Eigen::MatrixXd v;                ///< v_j in columns                  [D x n]
  const double* weights = nullptr;  ///< w, by columns
  Eigen::Index weight_stride = 0;   ///< from one column of w to the next; 0: one column for all
  Eigen::VectorXd column_weights;   ///< c                                   [n]
  bool lower_triangle = false;      ///< w is 0 above the diagonal: skip that half
};

struct ExponentialSums {
  Eigen::VectorXd rows;     ///< sum_j P_ij                                  [n]
  Eigen::VectorXd columns;  ///< sum_i P_ij                                  [n]
  Eigen::MatrixXd moments;  ///< sum_i P_ij u_i in columns               [D x n]
};

/// The exponent is clamped to [-500, 709]: e^-500 is nothing, and less could make products denormal,
/// for which a processor takes a hundred times as long. All entries must be finite.
/// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
void exponentialSums(const ExponentialMatrix& matrix, ExponentialSums* sums);

}  // namespace ddm::pilco
