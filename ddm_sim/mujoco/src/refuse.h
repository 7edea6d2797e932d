// Builds error messages about model files and plant files from texts and numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <stdexcept>

namespace ddm {

/// @throws std::invalid_argument with the concatenated parts; the function never returns
template <class... Parts>
[[noreturn]] void refuseModel(const Parts&... parts) {
  throw std::invalid_argument(textOf(parts...));
}

}  // namespace ddm
