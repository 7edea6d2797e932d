// Numbers that are not finite, for tests of what must be refused.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace ddm {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace ddm
