// Saturating cost: expectation and variance under a Gaussian, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/moments.h"

namespace ddm {
namespace pilco {

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

  /// c(x) of a known x.
  double value(const Eigen::VectorXd& x) const;

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

}  // namespace pilco
}  // namespace ddm
