// A policy with bounded controls: any policy followed by a squashing by two sines.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/squashed_policy.h"

#include <cmath>
#include <utility>

#include "ddm_pilco/messages.h"
#include "ddm_pilco/trigonometric.h"

namespace ddm::pilco {
namespace {

struct Wave {
  double factor;  // k
  double weight;  // w_k
};

constexpr Wave kWaves[] = {{1.0, 9.0 / 8.0}, {3.0, 1.0 / 8.0}};

}  // namespace

Squashing::Squashing(Eigen::VectorXd max_control) : max_control_(std::move(max_control)) {
  require(max_control_.size() >= 1, "squashing: there must be at least one control");
  require((max_control_.array() > 0.0).all() && max_control_.allFinite(),
          "squashing: the bounds of the controls must be positive, got ", max_control_.transpose());
}

Moments Squashing::predict(const Gaussian& input) const {
  requireSize(input, dim(), "squashing");
  const Eigen::VectorXd& m = input.mean;
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  Moments output = constantMoments(dim(), dim());
  for (int i = 0; i < dim(); ++i) {
    for (const Wave& k : kWaves) {
      const double scale =
          max_control_[i] * k.weight * std::exp(-0.5 * k.factor * k.factor * s(i, i));
      output.mean[i] += scale * std::sin(k.factor * m[i]);
      output.gain(i, i) += scale * k.factor * std::cos(k.factor * m[i]);
    }
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (const Wave& k : kWaves) {
        for (const Wave& l : kWaves) {
          sum += k.weight * l.weight *
                 sineCovariance(k.factor * m[i], l.factor * m[j], k.factor * k.factor * s(i, i),
                                l.factor * l.factor * s(j, j), k.factor * l.factor * s(i, j));
        }
      }
      output.covariance(i, j) = max_control_[i] * max_control_[j] * sum;
      output.covariance(j, i) = output.covariance(i, j);
    }
  }
  return output;
}

Moments Squashing::applyTo(const Moments& y) const {
  Moments output = predict(marginal(y));
  output.gain = y.gain * output.gain;
  return output;
}

Gaussian Squashing::backward(const Gaussian& input, const Moments& d_output) const {
  requireSize(input, dim(), "squashing");
  requireSize(d_output, dim(), dim(), "squashing");
  const Eigen::VectorXd& m = input.mean;
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  Gaussian d_input = constantGaussian(dim());
  for (int i = 0; i < dim(); ++i) {
    const double d_mean = d_output.mean[i];
    const double d_gain = d_output.gain(i, i);
    for (const Wave& k : kWaves) {
      const double square = k.factor * k.factor;
      const double scale = max_control_[i] * k.weight * std::exp(-0.5 * square * s(i, i));
      const double sine = scale * std::sin(k.factor * m[i]);
      const double cosine = scale * k.factor * std::cos(k.factor * m[i]);
      d_input.mean[i] += d_mean * cosine - d_gain * square * sine;
      d_input.covariance(i, i) -= 0.5 * square * (d_mean * sine + d_gain * cosine);
    }
    for (int j = 0; j < dim(); ++j) {
      const double weight = max_control_[i] * max_control_[j] * d_output.covariance(i, j);
      for (const Wave& k : kWaves) {
        for (const Wave& l : kWaves) {
          SineCovarianceGradient gradient;
          sineCovariance(k.factor * m[i], l.factor * m[j], k.factor * k.factor * s(i, i),
                         l.factor * l.factor * s(j, j), k.factor * l.factor * s(i, j), &gradient);
          const double w = weight * k.weight * l.weight;
          d_input.mean[i] += w * k.factor * gradient.mean_a;
          d_input.mean[j] += w * l.factor * gradient.mean_b;
          d_input.covariance(i, i) += w * k.factor * k.factor * gradient.variance;
          d_input.covariance(j, j) += w * l.factor * l.factor * gradient.variance;
          d_input.covariance(i, j) += w * k.factor * l.factor * gradient.covariance;
        }
      }
    }
  }
  d_input.covariance = symmetricPart(d_input.covariance);
  return d_input;
}

SquashedPolicy::SquashedPolicy(std::unique_ptr<Policy> policy, const Eigen::VectorXd& max_control)
    : policy_(std::move(policy)), squashing_(max_control) {
  require(policy_ != nullptr, "squashed policy: a policy is missing");
  require(policy_->outputDim() == squashing_.dim(),
          "squashed policy: there must be one bound for each control");
}

Moments SquashedPolicy::predict(const Gaussian& input) {
  return squashing_.applyTo(policy_->predict(input));
}

Gaussian SquashedPolicy::backward(const Gaussian& input, const Moments& d_output,
                                  Eigen::VectorXd* d_parameters) {
  requireSize(d_output, inputDim(), outputDim(), "squashed policy");
  const Moments before = policy_->predict(input);
  const Gaussian unbounded = marginal(before);
  const Eigen::MatrixXd slopes = squashing_.predict(unbounded).gain;
  const Gaussian d_unbounded = squashing_.backward(
      unbounded,
      Moments{d_output.mean, d_output.covariance, before.gain.transpose() * d_output.gain});
  return policy_->backward(
      input, Moments{d_unbounded.mean, d_unbounded.covariance, d_output.gain * slopes},
      d_parameters);
}

Eigen::VectorXd SquashedPolicy::control(const Eigen::VectorXd& features) {
  const Eigen::VectorXd& bound = squashing_.maxControl();
  return predict(known(features))
      .mean.cwiseMin(bound)
      .cwiseMax(-bound);  // rounding at the flat tops
}

}  // namespace ddm::pilco
