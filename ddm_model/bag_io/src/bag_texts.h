// Composes texts and errors about a bag.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>
#include <ros/time.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace ddm {

/// Remedy if a bag has one time twice.
constexpr char kOneRunPerBag[] =
    "record each run of a simulation, whose time begins anew, in a bag of its own";

/// @return a time as text, such as "1700000000.020000 s"
inline std::string timeText(const ros::Time& time) { return std::to_string(time.toSec()) + " s"; }

/// @return a duration as text, such as "0.15 s"
inline std::string secondsText(double seconds) {
  char text[400];  // the largest double has 309 digits
  std::snprintf(text, sizeof(text), std::abs(seconds) < 1000.0 ? "%.3g s" : "%.0f s", seconds);
  return text;
}

/// @throws std::runtime_error with the parts as its text, which give the fault and the remedy
template <class... Parts>
[[noreturn]] void refuseBag(const Parts&... parts) {
  throw std::runtime_error(textOf(parts...));
}

}  // namespace ddm
