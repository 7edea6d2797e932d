// Saturating cost, and the cost of a state: that of its features.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/trigonometric.h"

namespace ddm::pilco {

/// c(x) = 1 - exp(-1/2 (x - z)^T W (x - z)) (Deisenroth and Rasmussen, 2011). For x ~ N(m, s),
/// with P_k = W (I + k s W)^-1:
///
///   E[c]         = 1 - |I + s W|^-1/2 exp(-1/2 (m - z)^T P_1 (m - z))
///   E[(1 - c)^2] = |I + 2 s W|^-1/2 exp(-(m - z)^T P_2 (m - z))
class SaturatingCost {
 public:
  /// @param target  z                                                  [D]
  /// @param weight  W, symmetric and positive semi-definite        [D x D]
  /// @throws std::invalid_argument if the sizes do not fit or W is not symmetric
  SaturatingCost(Eigen::VectorXd target, const Eigen::MatrixXd& weight);

  int inputDim() const { return static_cast<int>(target_.size()); }

  /// E[c].
  /// @param d_input  (optional) out: dE[c]/dm, dE[c]/ds (symmetric)
  /// @throws std::invalid_argument for a wrong input dimension
  double expected(const Gaussian& input, Gaussian* d_input = nullptr) const;

  /// var[c]. What is below 1e-12 is rounding and becomes 0.
  double variance(const Gaussian& input) const;

 private:
  Eigen::VectorXd target_;
  Eigen::MatrixXd weight_;
};

/// c(y(x)) with the features y of an Augmentation, which are taken as Gaussian.
class StateCost {
 public:
  /// @throws std::invalid_argument if the features have another size than the target of the cost
  StateCost(Augmentation features, SaturatingCost cost);

  int inputDim() const { return features_.inputDim(); }

  /// Expected cost. Parameters and errors as in SaturatingCost.
  double expected(const Gaussian& state, Gaussian* d_state = nullptr) const;

  double variance(const Gaussian& state) const;

 private:
  Augmentation features_;
  SaturatingCost cost_;
};

/// 1 - exp(-d^2 / (2 width^2)), d the distance of the tip of a pendulum from its upright position.
/// State [dphi, phi], phi = pi upright.
/// @param length  of the pendulum [m]
/// @param width   [m]
/// @throws std::invalid_argument if one is not positive
StateCost pendulumCost(double length = 1.0, double width = 0.5);

}  // namespace ddm::pilco
