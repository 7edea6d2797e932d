// Functions for angles of joints.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace ddm {

constexpr double kPi = 3.14159265358979323846;

/// Absolute difference of two angles [rad], measured along the shorter arc, in [0, 180] deg.
inline double degreesBetween(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * kPi)) * 180.0 / kPi;
}

}  // namespace ddm
