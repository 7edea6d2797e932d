// Fully connected arctan network: the common building block of encoder, decoder and f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <type_traits>
#include <vector>

namespace ddm {

/// Replaces x_i by atan(x_i) and sets slope_i = 1 / (1 + x_i^2), in a loop that vectorises.
///
///   |x| <= 1:  atan(x) = x p(x^2)          |x| > 1:  atan(x) = sign(x) pi/2 + r p(r^2),  r = -1/x
///
/// p is the Chebyshev interpolant of atan(sqrt(s))/sqrt(s) on [0, 1] with 9 terms (float) or 22
/// terms (double). The error is at most 3e-7 (float) or 5e-16 (double). NaN stays NaN; +-inf
/// becomes +-pi/2 with slope 0.
///
/// @param x      in: n values; out: their arctan [rad]
/// @param slope  out: n values; must not overlap x
void arctan(float* x, float* slope, Eigen::Index n);
void arctan(double* x, double* slope, Eigen::Index n);

/// Kronecker factors of one layer, which approximate its Gauss-Newton matrix (K-FAC: Martens and
/// Grosse, ICML 2015). For the weights W and biases b of the layer and a sum of squares V,
///
///   d^2 V / d[W b]^2  ~  (sum_i a_i a_i') (x) (sum_i e_i e_i') / N
///
/// a_i is the input of the layer for sample i with a 1 appended. e_i is the derivative by the
/// output of the layer, back-propagated from independent errors of variance 1 at the network's
/// output.
template <class Scalar>
struct KroneckerFactors {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  Matrix inputs;                 ///< sum_i a_i a_i'  [width_in + 1 x width_in + 1]
  Matrix errors;                 ///< sum_i e_i e_i'        [width_out x width_out]
  Eigen::Index num_samples = 0;  ///< N

  KroneckerFactors(Eigen::Index width_in, Eigen::Index width_out)
      : inputs(Matrix::Zero(width_in + 1, width_in + 1)),
        errors(Matrix::Zero(width_out, width_out)) {}

  /// Adds samples.
  /// @param a  inputs of the layer, without the 1   [width_in x N]
  /// @param e  derivatives by its outputs          [width_out x N]
  void add(const Eigen::Ref<const Matrix>& a, const Eigen::Ref<const Matrix>& e) {
    const Eigen::Index width = a.rows();
    inputs.topLeftCorner(width, width).noalias() += a * a.transpose();
    inputs.col(width).head(width) += a.rowwise().sum();
    inputs.row(width).head(width) = inputs.col(width).head(width).transpose();
    inputs(width, width) += static_cast<Scalar>(a.cols());
    errors.noalias() += e * e.transpose();
    num_samples += a.cols();
  }

  /// Adds the factors of further samples of the same layer.
  void add(const KroneckerFactors& other) {
    inputs += other.inputs;
    errors += other.errors;
    num_samples += other.num_samples;
  }
};

/// Kronecker factors of all layers of one or several networks, in the order of their parameters.
template <class Scalar>
using LayerFactors = std::vector<KroneckerFactors<Scalar>>;

/// Fully connected network (paper, Sec. 2.1).
///
///   a_0 = input,   a_l = atan(W_l a_{l-1} + b_l) for l < L,   a_L = W_L a_{L-1} + b_L, or its atan
///
/// Samples are columns. The caller owns the parameters, one flat vector, so that the joint
/// objective V_R + V_P is a plain function of theta. Of the solvers, only kfac uses the division
/// into layers. Scalar is float for training, and double for planning and for the gradient tests.
template <class Scalar>
class Mlp {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  enum class Output { kLinear, kArctan };  ///< activation of the last layer

  /// Record of a forward pass for backward(), and the memory of both. The tape is an explicit
  /// argument, so that backward() cannot use the activations of another batch by mistake. Buffers
  /// grow to the largest batch and are then reused.
  struct Tape {
    Eigen::Index num_samples = 0;     ///< N of the last forward pass
    std::vector<Matrix> activations;  ///< a_0 ... a_L, each [width_l x >= N]
    /// da_l/d(W_l a_{l-1} + b_l) for l = 1 ... L, each [width_l x >= N]
    std::vector<Matrix> slopes;
    Vector ones;  ///< all 1; multiplying by it sums errors over samples  [>= N]
    /// Factors of this network's layers, first layer first, to which backward() adds. Null: none
    KroneckerFactors<Scalar>* factors = nullptr;

    /// @return a_L  [width_L x N]
    typename Matrix::ColsBlockXpr output() { return activations.back().leftCols(num_samples); }
  };

  /// @param widths  layer widths, input first, each at least 1                            [L + 1]
  /// @param output  activation of the last layer
  Mlp(std::vector<int> widths, Output output);

  const std::vector<int>& widths() const { return widths_; }
  int numLayers() const { return static_cast<int>(widths_.size()) - 1; }
  int inputDim() const { return widths_.front(); }
  int outputDim() const { return widths_.back(); }
  /// @return P, the number of parameters: W_1 (column-major), b_1, ..., W_L, b_L
  Eigen::Index numParams() const { return num_params_; }

  /// Appends one zero factor for each layer.
  void appendZeroFactors(LayerFactors<Scalar>* factors) const;

  /// Views of the weights and biases of one layer (0 is the first) in a parameter vector.
  template <class Pointer>
  auto weights(Pointer theta, int layer) const {
    return View<Pointer, Matrix>(theta + offsets_[layer], widths_[layer + 1], widths_[layer]);
  }
  template <class Pointer>
  auto biases(Pointer theta, int layer) const {
    const Eigen::Index num_weights = static_cast<Eigen::Index>(widths_[layer + 1]) * widths_[layer];
    return View<Pointer, Vector>(theta + offsets_[layer] + num_weights, widths_[layer + 1]);
  }

  /// Reserves the inputs of the next forward pass in a tape, one sample per column.
  /// @return a_0, which the caller fills  [width_0 x num_samples]
  typename Matrix::ColsBlockXpr inputs(Eigen::Index num_samples, Tape* tape) const;

  /// Computes the outputs for the inputs that the caller has written to inputs().
  /// @param theta  parameters                                                             [P]
  /// @param tape   in: inputs(); out: activations and slopes; tape->output() is the result
  void forward(const Scalar* theta, Tape* tape) const;

  /// Copies the inputs to the tape and computes the outputs.
  /// @param theta   parameters                                                            [P]
  /// @param inputs  one sample per column                                       [width_0 x N]
  /// @param tape    out: activations and slopes; tape->output() is the result
  /// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
  void forward(const Scalar* theta, const Eigen::Ref<const Matrix>& inputs, Tape* tape) const;

  /// Vector-Jacobian product of forward(). Consumes the tape: its slopes become the error signals.
  /// @param theta      parameters of the forward pass                                     [P]
  /// @param tape       tape of the forward pass
  /// @param d_outputs  dV/d output                                              [width_L x N]
  /// @param d_theta    dV/d theta is ADDED to it, as the terms of V share theta. Null: skip [P]
  /// @param d_inputs   out: dV/d input in its first N columns; grows if needed. Null: skip
  ///                                                                           [width_0 x >= N]
  void backward(const Scalar* theta, Tape* tape, const Eigen::Ref<const Matrix>& d_outputs,
                Scalar* d_theta, Matrix* d_inputs) const;

 private:
  template <class Pointer, class Values>
  using View = Eigen::Map<std::conditional_t<std::is_const<std::remove_pointer_t<Pointer>>::value,
                                             const Values, Values>>;

  std::vector<int> widths_;
  Output output_;
  std::vector<Eigen::Index> offsets_;  // offset of each layer in theta
  Eigen::Index num_params_ = 0;
};

/// @return widths of a network with the given hidden layers, input first
inline std::vector<int> layerWidths(int first, const std::vector<int>& hidden, int last) {
  std::vector<int> widths = {first};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  widths.push_back(last);
  return widths;
}

/// Draws parameters: weights from N(0, 1 / fan-in), biases 0. std::normal_distribution makes the
/// numbers depend on the standard library (here: libstdc++).
/// @param theta  out: parameters  [P]
template <class Scalar>
void randomise(const Mlp<Scalar>& net, std::mt19937_64* rng, Scalar* theta) {
  std::normal_distribution<double> normal;
  for (int layer = 0; layer < net.numLayers(); ++layer) {
    Eigen::Map<typename Mlp<Scalar>::Matrix> w = net.weights(theta, layer);
    const double scale = 1.0 / std::sqrt(static_cast<double>(w.cols()));
    for (Eigen::Index i = 0; i < w.size(); ++i)
      w.data()[i] = static_cast<Scalar>(scale * normal(*rng));
    net.biases(theta, layer).setZero();
  }
}

extern template class Mlp<float>;
extern template class Mlp<double>;

}  // namespace ddm
