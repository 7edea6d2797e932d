// Covariance of the sines of two jointly Gaussian angles, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/sine_covariance.h"

#include <cmath>

namespace ddm {
namespace pilco {
namespace {

/// exp(-v) (exp(c) - 1): exact for small c, and finite where exp(c) alone is not.
double scaledGrowth(double v, double c) {
  return std::abs(c) < 1.0 ? std::exp(-v) * std::expm1(c) : std::exp(c - v) - std::exp(-v);
}

}  // namespace

double sineCovariance(double mean_a, double mean_b, double variance_a, double variance_b,
                      double covariance, SineCovarianceGradient* gradient) {
  const double half_sum = 0.5 * (variance_a + variance_b);
  const double p = scaledGrowth(half_sum, covariance);
  const double r = scaledGrowth(half_sum, -covariance);
  const double difference = mean_a - mean_b;
  const double sum = mean_a + mean_b;
  const double value = 0.5 * (p * std::cos(difference) - r * std::cos(sum));
  if (gradient != nullptr) {
    gradient->mean_a = 0.5 * (-p * std::sin(difference) + r * std::sin(sum));
    gradient->mean_b = 0.5 * (p * std::sin(difference) + r * std::sin(sum));
    gradient->variance_a = gradient->variance_b = -0.5 * value;
    gradient->covariance = 0.5 * (std::exp(covariance - half_sum) * std::cos(difference) +
                                  std::exp(-covariance - half_sum) * std::cos(sum));
  }
  return value;
}

}  // namespace pilco
}  // namespace ddm
