// pilco_check: whole Jacobians, in the layout of the files, from vector-Jacobian products.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/gp_model.h"
#include "ddm_pilco/moments.h"

namespace ddm {
namespace pilco {
namespace check {

/// Derivatives of an array, vectorised by columns, in mean and covariance of the input.
struct Jacobian {
  Eigen::MatrixXd mean;        ///< [size x D]
  Eigen::MatrixXd covariance;  ///< [size x D^2]
};

/// @param seed      an adjoint of the outputs, all 0
/// @param array     the array of `seed` that is differentiated
/// @param backward  dJ/d outputs -> dJ/d input
template <class Seed, class Array, class Backward>
Jacobian jacobian(Seed* seed, Array* array, int input_dim, const Backward& backward) {
  Jacobian out;
  out.mean.resize(array->size(), input_dim);
  out.covariance.resize(array->size(), input_dim * input_dim);
  for (Eigen::Index i = 0; i < array->size(); ++i) {
    array->data()[i] = 1.0;
    const Gaussian d_input = backward(*seed);
    array->data()[i] = 0.0;
    out.mean.row(i) = d_input.mean.transpose();
    out.covariance.row(i) =
        Eigen::Map<const Eigen::RowVectorXd>(d_input.covariance.data(), input_dim * input_dim);
  }
  return out;
}

/// Columns (p, q) and (q, p) by their mean. Only their sum has a meaning: a covariance is
/// symmetric, and how the derivative is divided between the two is an accident of the formula.
inline Eigen::MatrixXd symmetrized(const Eigen::MatrixXd& d_covariance, Eigen::Index dim) {
  Eigen::MatrixXd out(d_covariance.rows(), d_covariance.cols());
  for (Eigen::Index p = 0; p < dim; ++p) {
    for (Eigen::Index q = 0; q < dim; ++q) {
      out.col(q * dim + p) = 0.5 * (d_covariance.col(q * dim + p) + d_covariance.col(p * dim + q));
    }
  }
  return out;
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
