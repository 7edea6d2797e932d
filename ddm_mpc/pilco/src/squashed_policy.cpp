// A policy with bounded controls: any policy followed by the squashing.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/squashed_policy.h"

#include <stdexcept>
#include <utility>

namespace ddm {
namespace pilco {

SquashedPolicy::SquashedPolicy(std::unique_ptr<Policy> policy, const Eigen::VectorXd& max_control)
    : policy_(std::move(policy)), squashing_(max_control) {
  if (policy_ == nullptr) throw std::invalid_argument("squashed policy: a policy is missing");
  if (policy_->outputDim() != squashing_.dim()) {
    throw std::invalid_argument("squashed policy: there must be one bound for each control");
  }
}

Moments SquashedPolicy::predict(const Gaussian& input) {
  const Moments before = policy_->predict(input);
  Moments output = squashing_.predict(Gaussian{before.mean, before.covariance});
  output.gain = before.gain * output.gain;
  return output;
}

Gaussian SquashedPolicy::backward(const Gaussian& input, const Moments& d_output,
                                  Eigen::VectorXd* d_parameters) {
  requireSize(d_output, inputDim(), outputDim(), "squashed policy");
  const Moments before = policy_->predict(input);
  const Gaussian unbounded{before.mean, before.covariance};
  const Eigen::MatrixXd slopes = squashing_.predict(unbounded).gain;
  const Gaussian d_unbounded = squashing_.backward(
      unbounded,
      Moments{d_output.mean, d_output.covariance, before.gain.transpose() * d_output.gain});
  return policy_->backward(
      input, Moments{d_unbounded.mean, d_unbounded.covariance, d_output.gain * slopes},
      d_parameters);
}

Eigen::VectorXd SquashedPolicy::control(const Eigen::VectorXd& features) {
  const Gaussian known{features, Eigen::MatrixXd::Zero(features.size(), features.size())};
  const Eigen::VectorXd& bound = squashing_.maxControl();
  return predict(known).mean.cwiseMin(bound).cwiseMax(-bound);  // rounding at the flat tops
}

}  // namespace pilco
}  // namespace ddm
