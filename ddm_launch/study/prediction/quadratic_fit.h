// Least-squares quadratic map between two sets of vectors, and how much it explains.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <stdexcept>
#include <string>

namespace ddm {

/// y ~ C [1, x_i, x_i x_j (i <= j)]: what a feature tells of a position if it is allowed to be a
/// bent picture of it.
class QuadraticFit {
 public:
  /// @param x  one sample per column  [n x N]
  /// @param y  one sample per column  [m x N]
  /// @throws std::invalid_argument if the numbers of samples differ
  QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
    if (x.cols() != y.cols() || x.cols() == 0) {
      throw std::invalid_argument("quadratic fit: as many samples of x as of y are needed, got " +
                                  std::to_string(x.cols()) + " and " + std::to_string(y.cols()));
    }
    coefficients_ = monomials(x).transpose().colPivHouseholderQr().solve(y.transpose()).transpose();
  }

  /// R^2 = 1 - sum |y - fit(x)|^2 / sum |y - mean(y)|^2 over all entries; 1 is perfect, may be
  /// negative on samples that were not fitted.
  /// @throws std::invalid_argument if all y are equal
  double explained(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) const {
    const Eigen::MatrixXd spread = y.colwise() - y.rowwise().mean().eval();
    if (spread.isZero(0.0)) {
      throw std::invalid_argument(
          "quadratic fit: there is nothing to explain, all samples are equal");
    }
    return 1.0 - (y - coefficients_ * monomials(x)).squaredNorm() / spread.squaredNorm();
  }

 private:
  /// [1, x_i, x_i x_j (i <= j)] of each sample.
  static Eigen::MatrixXd monomials(const Eigen::MatrixXd& x) {
    const Eigen::Index n = x.rows();
    Eigen::MatrixXd out(1 + n + n * (n + 1) / 2, x.cols());
    out.row(0).setOnes();
    out.middleRows(1, n) = x;
    Eigen::Index row = 1 + n;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i; j < n; ++j) out.row(row++) = x.row(i).cwiseProduct(x.row(j));
    }
    return out;
  }

  Eigen::MatrixXd coefficients_;  // C
};

}  // namespace ddm
