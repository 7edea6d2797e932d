// Fully connected arctan network: the common building block of encoder, decoder and f.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/mlp.h"

#include <utility>

namespace ddm {
namespace {

/// Resizes a buffer to at least n columns. An empty batch still needs the right number of rows.
template <class Matrix>
void reserve(Eigen::Index rows, Eigen::Index n, Matrix* matrix) {
  if (matrix->rows() != rows || matrix->cols() < n) matrix->resize(rows, n);
}

}  // namespace

template <class Scalar>
Mlp<Scalar>::Mlp(std::vector<int> widths, Output output)
    : widths_(std::move(widths)), output_(output) {
  eigen_assert(widths_.size() >= 2);
  for (size_t l = 1; l < widths_.size(); ++l) {
    offsets_.push_back(num_params_);
    num_params_ += static_cast<Eigen::Index>(widths_[l]) * (widths_[l - 1] + 1);
  }
}

template <class Scalar>
void Mlp<Scalar>::appendZeroFactors(LayerFactors<Scalar>* factors) const {
  for (size_t l = 1; l < widths_.size(); ++l) factors->emplace_back(widths_[l - 1], widths_[l]);
}

template <class Scalar>
typename Mlp<Scalar>::Matrix::ColsBlockXpr Mlp<Scalar>::inputs(Eigen::Index num_samples,
                                                               Tape* tape) const {
  tape->num_samples = num_samples;
  tape->activations.resize(widths_.size());
  tape->slopes.resize(widths_.size() - 1);
  reserve(inputDim(), num_samples, &tape->activations[0]);
  return tape->activations[0].leftCols(num_samples);
}

template <class Scalar>
void Mlp<Scalar>::forward(const Scalar* theta, const Eigen::Ref<const Matrix>& inputs,
                          Tape* tape) const {
  eigen_assert(inputs.rows() == inputDim());
  this->inputs(inputs.cols(), tape) = inputs;
  forward(theta, tape);
}

template <class Scalar>
void Mlp<Scalar>::forward(const Scalar* theta, Tape* tape) const {
  const Eigen::Index n = tape->num_samples;
  for (int layer = 0; layer < numLayers(); ++layer) {
    Matrix& a = tape->activations[layer + 1];
    Matrix& slope = tape->slopes[layer];
    reserve(widths_[layer + 1], n, &a);
    reserve(widths_[layer + 1], n, &slope);
    a.leftCols(n).colwise() = biases(theta, layer);
    a.leftCols(n).noalias() += weights(theta, layer) * tape->activations[layer].leftCols(n);
    const bool linear = layer + 1 == numLayers() && output_ == Output::kLinear;
    if (!linear) arctan(a.data(), slope.data(), a.rows() * n);
  }
}

template <class Scalar>
void Mlp<Scalar>::backward(const Scalar* theta, Tape* tape,
                           const Eigen::Ref<const Matrix>& d_outputs, Scalar* d_theta,
                           Matrix* d_inputs) const {
  const Eigen::Index n = tape->num_samples;
  eigen_assert(d_outputs.rows() == outputDim() && d_outputs.cols() == n);
  if (output_ == Output::kLinear) {
    tape->slopes.back().leftCols(n) = d_outputs;
  } else {
    tape->slopes.back().leftCols(n).array() *= d_outputs.array();
  }
  if (tape->ones.size() < n) tape->ones.setOnes(n);
  for (int layer = numLayers() - 1; layer >= 0; --layer) {
    const auto delta = tape->slopes[layer].leftCols(n);
    if (d_theta != nullptr) {
      weights(d_theta, layer).noalias() += delta * tape->activations[layer].leftCols(n).transpose();
      biases(d_theta, layer).noalias() += delta * tape->ones.head(n);
    }
    if (tape->factors != nullptr) {
      tape->factors[layer].add(tape->activations[layer].leftCols(n), delta);
    }
    if (layer > 0) {
      // a_layer is not needed any more, so that its memory can store the error of this layer.
      auto arriving = tape->activations[layer].leftCols(n);
      arriving.noalias() = weights(theta, layer).transpose() * delta;
      tape->slopes[layer - 1].leftCols(n).array() *= arriving.array();
    } else if (d_inputs != nullptr) {
      reserve(inputDim(), n, d_inputs);
      d_inputs->leftCols(n).noalias() = weights(theta, layer).transpose() * delta;
    }
  }
}

template class Mlp<float>;
template class Mlp<double>;

}  // namespace ddm
