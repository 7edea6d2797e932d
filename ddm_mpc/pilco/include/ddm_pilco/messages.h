// Texts of errors, and the rules that arguments must keep.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm::pilco {

/// All parts one after the other, as a stream prints them.
template <class... Parts>
std::string message(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// @param ok  to be written so that NaN makes it false
/// @throws std::invalid_argument that says all parts, unless `ok`
template <class... Parts>
void require(bool ok, const Parts&... parts) {
  if (!ok) throw std::invalid_argument(message(parts...));
}

}  // namespace ddm::pilco
