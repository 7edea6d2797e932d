// Gradient check: analytic gradients against central differences in double precision.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "ddm_model/minimise.h"

namespace ddm {
namespace testing {

/// Derivative of f at x along a direction by central differences of fourth order:
///
///   f' = (8 (f(x + h d) - f(x - h d)) - (f(x + 2 h d) - f(x - 2 h d))) / (12 h) + O(h^4)
///
/// With h = 7e-4 the truncation and the rounding of a function of size 1 are both about 1e-12.
inline double centralDifference(const DifferentiableFunction& f, const Eigen::VectorXd& x,
                                const Eigen::VectorXd& direction, double h) {
  const auto at = [&](double step) { return f(x + step * direction, nullptr); };
  return (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
}

constexpr double kDifferenceStep = 7e-4;

/// Checks every entry. The error of an entry is relative to max(|entry|, 1e-3 of the largest one):
/// what is next to nothing beside the others cannot be measured by differences.
/// @return failure if the worst error exceeds the tolerance or is NaN; it names the entry
inline ::testing::AssertionResult gradientMatches(const DifferentiableFunction& f,
                                                  const Eigen::VectorXd& x,
                                                  double tolerance = 1e-6) {
  Eigen::VectorXd gradient =
      Eigen::VectorXd::Constant(x.size(), std::numeric_limits<double>::quiet_NaN());
  const double value = f(x, &gradient);
  if (!(value == f(x, nullptr))) {
    return ::testing::AssertionFailure() << "the value differs with and without gradient";
  }
  if (gradient.size() != x.size()) {
    return ::testing::AssertionFailure()
           << "the gradient has " << gradient.size() << " entries, x has " << x.size();
  }
  Eigen::VectorXd numeric(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double h = kDifferenceStep * std::max(1.0, std::abs(x[i]));
    numeric[i] = centralDifference(f, x, Eigen::VectorXd::Unit(x.size(), i), h);
  }
  if (!gradient.allFinite() || !numeric.allFinite()) {  // or NaN would hide in a maximum
    return ::testing::AssertionFailure() << "not finite: analytic " << gradient.transpose()
                                         << ", numeric " << numeric.transpose();
  }
  const double floor = std::max(1e-3 * gradient.lpNorm<Eigen::Infinity>(), 1e-12);
  const Eigen::VectorXd error =
      (gradient - numeric).cwiseAbs().cwiseQuotient(gradient.cwiseAbs().cwiseMax(floor));
  Eigen::Index at = 0;
  if (error.maxCoeff(&at) <= tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "worst entry " << at << " of " << x.size() << ": analytic " << gradient[at]
         << ", numeric " << numeric[at] << ", relative error " << error[at];
}

}  // namespace testing
}  // namespace ddm
