// Covariance of the sines of two jointly Gaussian angles, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {
namespace pilco {

struct SineCovarianceGradient {
  double mean_a = 0.0;
  double mean_b = 0.0;
  double variance_a = 0.0;
  double variance_b = 0.0;
  double covariance = 0.0;
};

/// cov(sin a, sin b) for a ~ N(m_a, v_a), b ~ N(m_b, v_b), cov(a, b) = c:
///
///   (p cos(m_a - m_b) - r cos(m_a + m_b)) / 2,   p = q (e^c - 1),  r = q (e^-c - 1),
///   q = exp(-(v_a + v_b) / 2)
///
/// A cosine is a sine whose mean is pi/2 greater. For a = b, c is the variance.
/// @param gradient  (optional) out; the five arguments count as independent
double sineCovariance(double mean_a, double mean_b, double variance_a, double variance_b,
                      double covariance, SineCovarianceGradient* gradient = nullptr);

}  // namespace pilco
}  // namespace ddm
