// Least-squares quadratic map between two sets of vectors, and how much it explains.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ddm {

/// y ~ C [1, x_i, x_i x_j (i <= j)]: what a feature tells of a position if it is allowed to be a
/// bent picture of it.
class QuadraticFit {
 public:
  /// @param x  one sample per column  [n x N]
  /// @param y  one sample per column  [m x N]
  /// @throws std::invalid_argument if the numbers of samples differ
  QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y);

  /// R^2 = 1 - sum |y - fit(x)|^2 / sum |y - mean(y)|^2 over all entries; 1 is perfect, may be
  /// negative on samples that were not fitted.
  /// @throws std::invalid_argument if all y are equal
  double explained(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) const;

 private:
  Eigen::MatrixXd coefficients_;  // C
};

}  // namespace ddm
