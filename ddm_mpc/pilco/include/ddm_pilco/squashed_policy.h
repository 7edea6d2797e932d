// A policy with bounded controls: any policy followed by the squashing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>

#include "ddm_pilco/policy.h"
#include "ddm_pilco/squashing.h"

namespace ddm {
namespace pilco {

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

  const Eigen::VectorXd& maxControl() const { return squashing_.maxControl(); }

 private:
  std::unique_ptr<Policy> policy_;
  Squashing squashing_;
};

}  // namespace pilco
}  // namespace ddm
