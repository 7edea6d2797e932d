// Cost of a state: saturating cost of its features.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/saturating_cost.h"
#include "ddm_pilco/trigonometric.h"

namespace ddm {
namespace pilco {

/// c(y(x)) with the features y of an Augmentation, which are taken as Gaussian.
class StateCost {
 public:
  /// @throws std::invalid_argument if the features have another size than the target of the cost
  StateCost(Augmentation features, SaturatingCost cost);

  int inputDim() const { return features_.inputDim(); }

  /// Cost of a known state.
  double value(const Eigen::VectorXd& x) const;

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

}  // namespace pilco
}  // namespace ddm
