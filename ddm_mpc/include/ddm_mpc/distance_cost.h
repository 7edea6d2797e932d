// What a distance to the goal costs: quadratic as in the paper, or saturating.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace ddm {

/// c(d) = d^2, or, saturating at 2 w^2, c(d) = 2 w^2 (1 - exp(-d^2 / (2 w^2))), with distances d in
/// units of `scale`. Near the goal the two agree, so that a torque keeps its price.
struct DistanceCost {
  double scale = 1.0;            ///< unit of distance [feature]
  double width = 0.0;            ///< w, in that unit; 0: quadratic
  double terminal_weight = 1.0;  ///< c of the last step counts so often [-]

  /// @param squared  d^2 [feature^2]
  /// @param slope    out: dc / d(d^2) [feature^-2]
  double of(double squared, double* slope) const {
    const double unit = 1.0 / (scale * scale);
    if (width == 0.0) {
      *slope = unit;
      return squared * unit;
    }
    const double two_w2 = 2.0 * width * width;
    const double decay = std::exp(-squared * unit / two_w2);
    *slope = unit * decay;
    return two_w2 * (1.0 - decay);
  }
};

}  // namespace ddm
