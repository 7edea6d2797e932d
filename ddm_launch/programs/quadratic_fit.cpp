// Least-squares quadratic map between two sets of vectors, and how much it explains.
// SPDX-License-Identifier: BSD-3-Clause
#include "quadratic_fit.h"

#include <Eigen/QR>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

/// [1, x_i, x_i x_j (i <= j)] of each sample.
Eigen::MatrixXd monomials(const Eigen::MatrixXd& x) {
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

}  // namespace

QuadraticFit::QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  if (x.cols() != y.cols() || x.cols() == 0) {
    throw std::invalid_argument("quadratic fit: as many samples of x as of y are needed, got " +
                                std::to_string(x.cols()) + " and " + std::to_string(y.cols()));
  }
  coefficients_ = monomials(x).transpose().colPivHouseholderQr().solve(y.transpose()).transpose();
}

double QuadraticFit::explained(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) const {
  const Eigen::VectorXd mean = y.rowwise().mean();
  if ((y.colwise() - mean).isZero(0.0)) {
    throw std::invalid_argument(
        "quadratic fit: there is nothing to explain, all samples are equal");
  }
  return 1.0 -
         (y - coefficients_ * monomials(x)).squaredNorm() / (y.colwise() - mean).squaredNorm();
}

}  // namespace ddm
