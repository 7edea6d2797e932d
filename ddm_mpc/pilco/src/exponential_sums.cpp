// Sums of n x n weighted exponentials: nearly all the time of PILCO is spent here.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/exponential_sums.h"

namespace ddm::pilco {

void exponentialSums(const ExponentialMatrix& matrix, const Eigen::Ref<const Eigen::MatrixXd>& w,
                     ExponentialSums* sums) {
  const Eigen::Index rows = matrix.u.rows();
  const Eigen::Index dim = matrix.u.cols();
  const Eigen::Index cols = matrix.g.size();
  const bool same_columns = w.cols() == 1;
  eigen_assert(matrix.f.size() == rows && matrix.v.rows() == dim && matrix.v.cols() == cols &&
               matrix.column_weights.size() == cols && w.rows() == rows &&
               (same_columns || w.cols() == cols));
  sums->rows.setZero(rows);
  sums->columns.resize(cols);
  sums->moments.resize(dim, cols);
  Eigen::VectorXd column(rows);  // a column at a time stays in the fastest cache
  for (Eigen::Index j = 0; j < cols; ++j) {
    const Eigen::Index n = same_columns ? rows : rows - j;
    const auto u = matrix.u.bottomRows(n);
    auto p = column.tail(n);
    p = matrix.f.tail(n);
    p.noalias() += u * matrix.v.col(j);
    p = (p.array() + matrix.g[j]).max(-500.0).min(709.0).exp() *
        w.col(same_columns ? 0 : j).tail(n).array() * matrix.column_weights[j];
    sums->rows.tail(n) += p;
    sums->columns[j] = p.sum();
    sums->moments.col(j).noalias() = u.transpose() * p;
  }
}

}  // namespace ddm::pilco
