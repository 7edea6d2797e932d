// The three networks of the deep dynamical model and where each lives in theta.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_model/prediction_model.h"

namespace ddm {

/// g^-1, g and f, and their places in the one flat vector theta = [theta_E, theta_D, theta_P].
///
///   z = g^-1(score; theta_E)  every layer through arctan, the feature too (paper, Sec. 2.1)
///   score_hat = g(z; theta_D) hidden layers through arctan, the output linear
template <class Scalar>
struct Networks {
  PredictionModel<Scalar> prediction_model;

  /// @throws std::invalid_argument if a width is < 1, or max_torque is for other motors
  Networks(const ModelOptions& options, int torque_dim)
      : prediction_model(options, torque_dim),
        encoder_(layerWidths(options.pca_dim, options.encoder_widths, options.feature_dim),
                 Mlp<Scalar>::Output::kArctan),
        decoder_(layerWidths(options.feature_dim, options.decoder_widths, options.pca_dim),
                 Mlp<Scalar>::Output::kLinear) {}

  Eigen::Index numParams() const { return predictorOffset() + f().numParams(); }
  const Mlp<Scalar>& encoder() const { return encoder_; }
  const Mlp<Scalar>& decoder() const { return decoder_; }
  const Mlp<Scalar>& f() const { return prediction_model.network(); }

  /// Start of theta_E, theta_D and theta_P in theta (const or not).
  template <class Pointer>
  Pointer encoderOf(Pointer theta) const {
    return theta;
  }
  template <class Pointer>
  Pointer decoderOf(Pointer theta) const {
    return theta + encoder().numParams();
  }
  template <class Pointer>
  Pointer predictorOf(Pointer theta) const {
    return theta + predictorOffset();
  }

 private:
  Eigen::Index predictorOffset() const { return encoder().numParams() + decoder().numParams(); }

  Mlp<Scalar> encoder_;  // g^-1: pca_dim ... feature_dim
  Mlp<Scalar> decoder_;  // g:    feature_dim ... pca_dim
};

}  // namespace ddm
