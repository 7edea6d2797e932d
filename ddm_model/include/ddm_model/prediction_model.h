// NARX prediction model f: the next feature from the last n features and torques.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ddm_model/mlp.h"
#include "ddm_model/model_options.h"

namespace ddm {

/// One-step prediction in feature space (paper, Sec. 2.2), without its parameters.
///
///   z_{t+1} = f(h; theta_P),   h = [z_t, u_t, z_{t-1}, u_{t-1}, ..., z_{t-n+1}, u_{t-n+1}]
///
/// with u in units of max_torque. The output layer is linear.
template <class Scalar>
class PredictionModel {
 public:
  /// @throws std::invalid_argument if a width is < 1
  PredictionModel(const ModelOptions& options, int torque_dim)
      : feature_dim_(options.feature_dim),
        torque_dim_(torque_dim),
        order_(options.order),
        network_(layers(options, torque_dim), Mlp<Scalar>::Output::kLinear) {}

  int featureDim() const { return feature_dim_; }
  int torqueDim() const { return torque_dim_; }
  /// @return n
  int order() const { return order_; }
  /// @return n (feature_dim + torque_dim), the size of h
  int regressorDim() const { return network_.inputDim(); }
  /// Where the feature of `lag` steps ago (0: the current one) starts in h.
  int featureRow(int lag) const { return lag * (feature_dim_ + torque_dim_); }
  /// Where the torque of `lag` steps ago starts in h.
  int torqueRow(int lag) const { return featureRow(lag) + feature_dim_; }

  const Mlp<Scalar>& network() const { return network_; }

 private:
  static std::vector<int> layers(const ModelOptions& options, int torque_dim) {
    std::vector<int> widths = {options.order * (options.feature_dim + torque_dim)};
    widths.insert(widths.end(), options.predictor_widths.begin(), options.predictor_widths.end());
    widths.push_back(options.feature_dim);
    return widths;
  }

  int feature_dim_;
  int torque_dim_;
  int order_;
  Mlp<Scalar> network_;
};

}  // namespace ddm
