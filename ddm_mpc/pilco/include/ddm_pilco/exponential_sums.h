// Sums of n x n weighted exponentials: nearly all the time of PILCO is spent here.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ddm::pilco {

/// Rows are padded to a multiple of this, so that a column is a whole number of vector registers.
constexpr int kRowPadding = 8;

/// Number of rows with padding.
inline int paddedRows(int n) { return (n + kRowPadding - 1) / kRowPadding * kRowPadding; }

/// The matrix P_ij = w_ij c_j exp(f_i + g_j + u_i^T v_j), N rows with padding, n columns. It is
/// never stored.
struct ExponentialMatrix {
  Eigen::VectorXd f;                ///<                                     [N]
  Eigen::VectorXd g;                ///<                                     [n]
  Eigen::MatrixXd u;                ///< u_i in rows                     [N x D]
  Eigen::MatrixXd v;                ///< v_j in columns                  [D x n]
  const double* weights = nullptr;  ///< w, by columns; 0 in the rows of the padding
  Eigen::Index weight_stride = 0;   ///< from one column of w to the next; 0: one column for all
  Eigen::VectorXd column_weights;   ///< c                                   [n]
  bool lower_triangle = false;      ///< w is 0 above the diagonal: skip that half
};

struct ExponentialSums {
  Eigen::VectorXd rows;     ///< sum_j P_ij                                  [N]
  Eigen::VectorXd columns;  ///< sum_i P_ij                                  [n]
  Eigen::MatrixXd moments;  ///< sum_i P_ij u_i in columns               [D x n]
};

/// Computes the sums with the vector instructions of the machine that runs it: AVX2 is used where
/// the processor has it, also in a build for any x86-64. The exponential is correct to 2 units in
/// the last place in [-500, 709] and clamped outside of it: e^-500 is nothing, and less could make
/// products denormal, for which a processor takes a hundred times as long. All entries must be
/// finite.
/// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
void exponentialSums(const ExponentialMatrix& matrix, ExponentialSums* sums);

}  // namespace ddm::pilco
