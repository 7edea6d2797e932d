// Squashing of controls into a bounded range by two sines: moments and derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/moments.h"

namespace ddm {
namespace pilco {

/// u = u_max (9 sin x + sin 3x) / 8 entry by entry: a wave with flat tops in [-u_max, u_max] and
/// slope 3/2 u_max at 0 (Deisenroth, Fox and Rasmussen, 2015, Sec. 5; the squashing of Deisenroth,
/// 2010, is a single sine). For x ~ N(m, s), w_1 = 9/8, w_3 = 1/8:
///
///   M_i  = u_max_i sum_k w_k exp(-k^2 s_ii / 2) sin(k m_i)
///   S_ij = u_max_i u_max_j sum_kl w_k w_l cov(sin k x_i, sin l x_j)
///   gain: diagonal, u_max_i sum_k w_k k exp(-k^2 s_ii / 2) cos(k m_i)
class Squashing {
 public:
  /// @param max_control  u_max, one for each control
  /// @throws std::invalid_argument if there is none, or one is not positive and finite
  explicit Squashing(Eigen::VectorXd max_control);

  int dim() const { return static_cast<int>(max_control_.size()); }
  const Eigen::VectorXd& maxControl() const { return max_control_; }

  /// @throws std::invalid_argument if the input has another dimension than max_control
  Moments predict(const Gaussian& input) const;

  /// Vector-Jacobian product of predict() at the same input. Only the diagonal of dJ/dV counts.
  Gaussian backward(const Gaussian& input, const Moments& d_output) const;

 private:
  Eigen::VectorXd max_control_;
};

}  // namespace pilco
}  // namespace ddm
