// A policy with bounded controls: any policy followed by a squashing by two sines.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>

#include "ddm_pilco/policy.h"

namespace ddm::pilco {

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

  /// Moments of squash(y) from those of y, which is taken as Gaussian.
  Moments applyTo(const Moments& y) const;

  /// Vector-Jacobian product of predict() at the same input. Only the diagonal of dJ/dV counts.
  Gaussian backward(const Gaussian& input, const Moments& d_output) const;

 private:
  Eigen::VectorXd max_control_;
};

/// Moments of u = squash(pi(x)). pi(x) is taken as Gaussian in between; the gain is that of pi
/// times the (diagonal) gain of the squashing.
class SquashedPolicy : public Policy {
 public:
  /// @param policy       pi, before squashing
  /// @param max_control  u_max, one for each control
  /// @throws std::invalid_argument without a policy, for another number of controls, or a u_max
  ///         that is not positive
  SquashedPolicy(std::unique_ptr<Policy> policy, const Eigen::VectorXd& max_control);

  int inputDim() const override { return policy_->inputDim(); }
  int outputDim() const override { return policy_->outputDim(); }
  Eigen::VectorXd parameters() const override { return policy_->parameters(); }
  void setParameters(const Eigen::VectorXd& p) override { policy_->setParameters(p); }
  Moments predict(const Gaussian& input) override;
  Gaussian backward(const Gaussian& input, const Moments& d_output,
                    Eigen::VectorXd* d_parameters) override;

  /// Control for known features: the mean of predict() with zero covariance.
  Eigen::VectorXd control(const Eigen::VectorXd& features);

 private:
  std::unique_ptr<Policy> policy_;
  Squashing squashing_;
};

}  // namespace ddm::pilco
