// Squashing of controls into a bounded range by two sines: moments and derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/squashing.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "ddm_pilco/sine_covariance.h"

namespace ddm {
namespace pilco {
namespace {

struct Wave {
  double factor;  // k
  double weight;  // w_k
};

constexpr Wave kWaves[] = {{1.0, 9.0 / 8.0}, {3.0, 1.0 / 8.0}};

}  // namespace

Squashing::Squashing(Eigen::VectorXd max_control) : max_control_(std::move(max_control)) {
  if (max_control_.size() < 1) {
    throw std::invalid_argument("squashing: there must be at least one control");
  }
  for (Eigen::Index i = 0; i < max_control_.size(); ++i) {
    if (!(max_control_[i] > 0.0) || !std::isfinite(max_control_[i])) {
      throw std::invalid_argument("squashing: the bound of a control must be positive, got " +
                                  std::to_string(max_control_[i]));
    }
  }
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
          d_input.covariance(i, i) += w * k.factor * k.factor * gradient.variance_a;
          d_input.covariance(j, j) += w * l.factor * l.factor * gradient.variance_b;
          d_input.covariance(i, j) += w * k.factor * l.factor * gradient.covariance;
        }
      }
    }
  }
  d_input.covariance = symmetricPart(d_input.covariance);
  return d_input;
}

}  // namespace pilco
}  // namespace ddm
