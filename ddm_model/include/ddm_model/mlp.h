// Fully connected arctan network: the common building block of g^-1, g and f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <type_traits>
#include <vector>

namespace ddm {

/// x_i becomes atan(x_i), slope_i = 1 / (1 + x_i^2), in a loop that the compiler can vectorise.
///
///   |x| <= 1:  atan(x) = x p(x^2)          |x| > 1:  atan(x) = sign(x) pi/2 + r p(r^2),  r = -1/x
///
/// p is the Chebyshev interpolant of atan(sqrt(s))/sqrt(s) on [0, 1]: 9 terms (float), 22 terms
/// (double). Error against the exact value: at most 3e-7 (float) and 5e-16 (double). NaN stays NaN,
/// +-inf becomes +-pi/2 with slope 0.
///
/// @param x      in: n values; out: their arctan [rad]
/// @param slope  out: n values; must not overlap x
void arctan(float* x, float* slope, Eigen::Index n);
void arctan(double* x, double* slope, Eigen::Index n);

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

/// Fully connected network (paper, Sec. 2.1).
///
///   a_0 = input,   a_l = atan(W_l a_{l-1} + b_l) for l < L,   a_L = W_L a_{L-1} + b_L, or its atan
///
/// Samples are columns. The parameters live in a flat vector owned by the caller, so that the joint
/// objective V_R + V_P is a plain function of theta; of the solvers only kfac knows layers.
/// Scalar is float for training and double for planning and for the gradient tests.
template <class Scalar>
class Mlp {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  enum class Output { kLinear, kArctan };  ///< activation of the last layer

  /// What backward() needs from the forward pass it differentiates, and the memory for both. Handed
  /// over explicitly: a backward() can never silently use the activations of another batch. Buffers
  /// grow to the largest batch seen and are then used again.
  struct Tape {
    Eigen::Index num_samples = 0;     ///< N of the last forward pass
    std::vector<Matrix> activations;  ///< a_0 ... a_L, each [width_l x >= N]
    std::vector<Matrix>
        slopes;   ///< da_l/d(W_l a_{l-1} + b_l) for l = 1 ... L, each [width_l x >= N]
    Vector ones;  ///< [>= N], whose product with errors sums them over samples
    /// backward() adds to those of the first layer and of the layers after it; null: not wanted
    KroneckerFactors<Scalar>* factors = nullptr;

    /// @return a_L  [width_L x N]
    typename Matrix::ColsBlockXpr output() { return activations.back().leftCols(num_samples); }
  };

  /// @param widths  layer widths, input first                                             [L + 1]
  /// @param output  activation of the last layer
  /// @throws std::invalid_argument if there are fewer than two widths or one is < 1
  Mlp(std::vector<int> widths, Output output);

  const std::vector<int>& widths() const { return widths_; }
  int numLayers() const { return static_cast<int>(widths_.size()) - 1; }
  int inputDim() const { return widths_.front(); }
  int outputDim() const { return widths_.back(); }
  /// @return P, the number of parameters: W_1 (column-major), b_1, ..., W_L, b_L
  Eigen::Index numParams() const { return num_params_; }

  /// Appends factors of all layers that nothing was added to yet.
  void appendZeroFactors(LayerFactors<Scalar>* factors) const;

  /// Views of one layer (0 is the first) inside a parameter vector, const or not.
  template <class Pointer>
  auto weights(Pointer theta, int layer) const {
    return View<Pointer, Matrix>(theta + offsets_[layer], widths_[layer + 1], widths_[layer]);
  }
  template <class Pointer>
  auto biases(Pointer theta, int layer) const {
    const Eigen::Index num_weights = static_cast<Eigen::Index>(widths_[layer + 1]) * widths_[layer];
    return View<Pointer, Vector>(theta + offsets_[layer] + num_weights, widths_[layer + 1]);
  }

  /// Room in a tape for the inputs of its next forward pass, one sample per column.
  /// @return a_0, to be filled  [width_0 x num_samples]
  typename Matrix::ColsBlockXpr inputs(Eigen::Index num_samples, Tape* tape) const;

  /// @param theta  parameters                                                             [P]
  /// @param tape   in: inputs(); out: activations and slopes; tape->output() is the result
  void forward(const Scalar* theta, Tape* tape) const;

  /// The same for inputs that are elsewhere.
  /// @param theta   parameters                                                            [P]
  /// @param inputs  one sample per column                                       [width_0 x N]
  /// @param tape    out: activations and slopes; tape->output() is the result
  /// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
  void forward(const Scalar* theta, const Eigen::Ref<const Matrix>& inputs, Tape* tape) const;

  /// Vector-Jacobian product of forward(). Uses the tape up: its slopes become the error signals.
  /// @param theta      parameters of the forward pass                                     [P]
  /// @param tape       tape of the forward pass
  /// @param d_outputs  dV/d output                                              [width_L x N]
  /// @param d_theta    dV/d theta is ADDED to this (see V_R + V_P); null: not wanted      [P]
  /// @param d_inputs   out: dV/d input in its first N columns, grows to have them; null: not wanted
  ///                                                                           [width_0 x >= N]
  void backward(const Scalar* theta, Tape* tape, const Eigen::Ref<const Matrix>& d_outputs,
                Scalar* d_theta, Matrix* d_inputs) const;

 private:
  template <class Pointer, class Values>
  using View = Eigen::Map<std::conditional_t<std::is_const<std::remove_pointer_t<Pointer>>::value,
                                             const Values, Values>>;

  std::vector<int> widths_;
  Output output_;
  std::vector<Eigen::Index> offsets_;  // where each layer starts in theta
  Eigen::Index num_params_ = 0;
};

/// Widths of a network with these hidden layers, input first.
inline std::vector<int> layerWidths(int first, const std::vector<int>& hidden, int last) {
  std::vector<int> widths = {first};
  widths.insert(widths.end(), hidden.begin(), hidden.end());
  widths.push_back(last);
  return widths;
}

/// Random parameters: weights N(0, 1 / fan-in), biases 0. (Fixed for a given libstdc++.)
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
