// Kronecker factors of the Gauss-Newton matrix of a network's layers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace ddm {

/// Approximates the Gauss-Newton matrix of one layer by a Kronecker product (K-FAC: Martens and Grosse,
/// ICML 2015). For the layer's weights W and biases b and a sum of squares V,
///
///   d^2 V / d[W b]^2  ~  (sum_i a_i a_i') (x) (sum_i e_i e_i') / N
///
/// a_i are the layer's inputs for sample i, followed by a 1. e_i are the derivatives by the layer's outputs,
/// back-propagated from independent errors of variance 1 at the outputs of the whole network.
template <class Scalar>
struct KroneckerFactors {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  Matrix inputs;                 ///< sum_i a_i a_i'  [width_in + 1 x width_in + 1]
  Matrix errors;                 ///< sum_i e_i e_i'        [width_out x width_out]
  Eigen::Index num_samples = 0;  ///< N

  KroneckerFactors(Eigen::Index width_in, Eigen::Index width_out)
      : inputs(Matrix::Zero(width_in + 1, width_in + 1)),
        errors(Matrix::Zero(width_out, width_out)) {}

  /// @param a  inputs of the layer, without the 1   [width_in x N]
  /// @param e  errors at its outputs               [width_out x N]
  void add(const Eigen::Ref<const Matrix>& a, const Eigen::Ref<const Matrix>& e) {
    const Eigen::Index width = a.rows();
    inputs.topLeftCorner(width, width).noalias() += a * a.transpose();
    inputs.col(width).head(width) += a.rowwise().sum();
    inputs.row(width).head(width) = inputs.col(width).head(width).transpose();
    inputs(width, width) += static_cast<Scalar>(a.cols());
    errors.noalias() += e * e.transpose();
    num_samples += a.cols();
  }

  /// Of further samples of the same layer.
  void add(const KroneckerFactors& other) {
    inputs += other.inputs;
    errors += other.errors;
    num_samples += other.num_samples;
  }
};

/// Of all layers of a network, or of several, in the order of their parameters.
template <class Scalar>
using LayerFactors = std::vector<KroneckerFactors<Scalar>>;

}  // namespace ddm
