// Mean of a Gaussian process: the prediction model f of model/predictor gp.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/gp_mean.h"

namespace ddm {

template <class Scalar>
void GpMean<Scalar>::forward(const Scalar* theta, const Eigen::Ref<const Matrix>& inputs,
                             Tape* tape) const {
  tape->num_samples = inputs.cols();
  tape->activations.resize(3);
  Matrix& scaled = tape->activations[0];
  Matrix& kernel = tape->activations[1];
  scaled = inverseScales(theta).asDiagonal() * inputs;
  const auto c = centres(theta);
  kernel.noalias() = c.transpose() * scaled;
  if (half_squared_norms_.size() > 0) {
    kernel.colwise() -= half_squared_norms_;
  } else {
    kernel.colwise() -= Scalar(0.5) * c.colwise().squaredNorm().transpose();
  }
  kernel.rowwise() -= Scalar(0.5) * scaled.colwise().squaredNorm();
  kernel = kernel.array().exp();
  Matrix& output = tape->activations[2];
  output.noalias() = weights(theta) * kernel;
  output.noalias() += slope(theta) * inputs;
  output.colwise() += bias(theta);
}

template <class Scalar>
void GpMean<Scalar>::backward(const Scalar* theta, Tape* tape,
                              const Eigen::Ref<const Matrix>& d_outputs, Matrix* d_inputs) const {
  const Eigen::Index num_samples = d_outputs.cols();
  const Matrix& scaled = tape->activations[0];
  Matrix& kernel = tape->activations[1];
  kernel.array() *= (weights(theta).transpose() * d_outputs).array();
  if (d_inputs->rows() != input_dim_ || d_inputs->cols() < num_samples) {
    d_inputs->resize(input_dim_, num_samples);
  }
  auto d_h = d_inputs->leftCols(num_samples);
  d_h.noalias() = centres(theta) * kernel;
  d_h -= scaled * kernel.colwise().sum().asDiagonal();
  d_h = inverseScales(theta).asDiagonal() * d_h;
  d_h.noalias() += slope(theta).transpose() * d_outputs;
}

template class GpMean<float>;
template class GpMean<double>;

}  // namespace ddm
