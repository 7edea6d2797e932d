// Mean of a Gaussian process: the prediction model f of model/predictor gp.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_model/mlp.h"

namespace ddm {

/// Mean of a sparse Gaussian process with several outputs, a linear mean function and one squared
/// exponential kernel (Rasmussen and Williams, 2006, Secs. 2.7 and 8.3.1):
///
///   f(h) = S h + b + sum_i w_i exp(-|h / l - c_i|^2 / 2)
///
/// with a length scale l for each input, so that the data decide which inputs count. The centres
/// c_i are inputs of training samples in units of l; fitGp() computes all parameters. Far from all
/// samples, f is linear. The class has the interface of Mlp, and the tape of Mlp.
template <class Scalar>
class GpMean {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Tape = typename Mlp<Scalar>::Tape;

  /// @param num_centres  M
  GpMean(int input_dim, int output_dim, Eigen::Index num_centres)
      : input_dim_(input_dim), output_dim_(output_dim), num_centres_(num_centres) {}

  /// @param num_params  numParams() of the object
  static GpMean ofSize(int input_dim, int output_dim, Eigen::Index num_params) {
    const GpMean linear(input_dim, output_dim, 0);
    return GpMean(input_dim, output_dim,
                  (num_params - linear.numParams()) / (input_dim + output_dim));
  }

  /// @return number of parameters: 1 / l, S, b, all centres, all weights (column-major)
  Eigen::Index numParams() const {
    return numBeforeCentres() + num_centres_ * (input_dim_ + output_dim_);
  }

  /// Views of the parameters in a parameter vector.
  auto inverseScales(const Scalar* theta) const {  // 1 / l  [input_dim]
    return Eigen::Map<const Vector>(theta, input_dim_);
  }
  auto slope(const Scalar* theta) const {  // S  [output_dim x input_dim]
    return Eigen::Map<const Matrix>(theta + input_dim_, output_dim_, input_dim_);
  }
  auto bias(const Scalar* theta) const {  // b  [output_dim]
    return Eigen::Map<const Vector>(theta + input_dim_ * (1 + output_dim_), output_dim_);
  }
  auto centres(const Scalar* theta) const {  // [input_dim x M]
    return Eigen::Map<const Matrix>(theta + numBeforeCentres(), input_dim_, num_centres_);
  }
  auto weights(const Scalar* theta) const {  // [output_dim x M]
    return Eigen::Map<const Matrix>(theta + numBeforeCentres() + input_dim_ * num_centres_,
                                    output_dim_, num_centres_);
  }

  /// Computes the norms of the centres once. Afterwards, forward() must always get parameters with
  /// the same centres. Without this call, forward() computes the norms each time, which takes a fifth
  /// of the time of a plan.
  void fixParameters(const Scalar* theta) {
    half_squared_norms_ = Scalar(0.5) * centres(theta).colwise().squaredNorm().transpose();
  }

  /// @param theta   parameters                                            [numParams()]
  /// @param inputs  one sample per column                              [input_dim x N]
  /// @param tape    out: inputs / l and kernel values; tape->output() is the result
  void forward(const Scalar* theta, const Eigen::Ref<const Matrix>& inputs, Tape* tape) const;

  /// Vector-Jacobian product of forward(). Consumes the tape.
  /// @param d_outputs  dV/d output                                     [output_dim x N]
  /// @param d_inputs   out: dV/d input in its first N columns; grows if needed
  ///                                                                  [input_dim x >= N]
  void backward(const Scalar* theta, Tape* tape, const Eigen::Ref<const Matrix>& d_outputs,
                Matrix* d_inputs) const;

 private:
  Eigen::Index numBeforeCentres() const {
    return input_dim_ + output_dim_ * (input_dim_ + Eigen::Index(1));
  }

  int input_dim_;
  int output_dim_;
  Eigen::Index num_centres_;
  Vector half_squared_norms_;  // |c_i|^2 / 2; empty: fixParameters() was not called  [M]
};

extern template class GpMean<float>;
extern template class GpMean<double>;

}  // namespace ddm
