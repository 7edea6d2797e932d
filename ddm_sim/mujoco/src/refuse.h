// Builds error messages about model files and plant files from texts and numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm {

/// Concatenates the parts; numbers are written as a stream writes them.
template <class... Parts>
std::string textOf(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// @throws std::invalid_argument with the concatenated parts; the function never returns
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw std::invalid_argument(textOf(parts...));
}

}  // namespace ddm
