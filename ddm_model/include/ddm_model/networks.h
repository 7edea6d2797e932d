// The three networks of the deep dynamical model and where each lives in theta.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_model/auto_encoder.h"
#include "ddm_model/prediction_model.h"

namespace ddm {

/// g^-1, g and f, and their places in the one flat vector theta = [theta_E, theta_D, theta_P].
template <class Scalar>
struct Networks {
  AutoEncoder<Scalar> auto_encoder;
  PredictionModel<Scalar> prediction_model;

  /// @throws std::invalid_argument if a width is < 1, or max_torque is for other motors
  Networks(const ModelOptions& options, int torque_dim)
      : auto_encoder(options), prediction_model(options, torque_dim) {}

  Eigen::Index numParams() const { return predictorOffset() + f().numParams(); }
  const Mlp<Scalar>& encoder() const { return auto_encoder.encoder; }
  const Mlp<Scalar>& decoder() const { return auto_encoder.decoder; }
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
};

}  // namespace ddm
