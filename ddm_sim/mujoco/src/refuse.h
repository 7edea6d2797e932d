// Error messages about model files and plant files, built from texts and numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm {

/// The parts one after the other, numbers as a stream writes them.
template <class... Parts>
std::string textOf(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// @throws std::invalid_argument with this text, always
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw std::invalid_argument(textOf(parts...));
}

}  // namespace ddm
