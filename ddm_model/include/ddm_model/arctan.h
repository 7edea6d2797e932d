// The activation sigma = arctan of the paper, on whole arrays, together with its slope.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace ddm {

/// x_i becomes atan(x_i), slope_i = 1 / (1 + x_i^2), in a loop that the compiler can vectorise.
///
///   |x| <= 1:  atan(x) = x p(x^2)          |x| > 1:  atan(x) = sign(x) pi/2 + r p(r^2),  r = -1/x
///
/// p is the Chebyshev interpolant of atan(sqrt(s))/sqrt(s) on [0, 1]: 9 terms (float), 22 terms
/// (double). Error against the exact value: at most 3e-7 (float) and 5e-16 (double). NaN stays NaN,
/// +-inf becomes +-pi/2 with slope 0.
///
/// @param x      in: n values; out: their arctan [rad]
/// @param slope  out: n values; must not overlap x
void arctan(float* x, float* slope, Eigen::Index n);
void arctan(double* x, double* slope, Eigen::Index n);

}  // namespace ddm
