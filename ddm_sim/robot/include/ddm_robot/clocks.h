// Two kinds of time, which cannot be mixed up: what guards a motor, and what pairs messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace ddm {

/// Of the monotonic clock, which nobody can set: all deadlines of the motor.
using SteadyTime = std::chrono::steady_clock::time_point;

/// Header stamp, since the epoch of the camera's clock: pairs an image with its torque and chooses
/// frames. It may shorten a deadline, never extend one.
using Stamp = std::chrono::nanoseconds;

inline double toSeconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

inline std::chrono::nanoseconds fromSeconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

}  // namespace ddm
