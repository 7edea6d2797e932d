// A number as text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <locale.h>

#include <boost/algorithm/string/trim.hpp>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <string>

namespace ddm {

/// A finite decimal number and nothing else: no hexadecimal, no nan, no inf, no unit behind it.
/// Blanks around it are allowed.
/// @return false, with `value` unchanged, if `text` is anything else
inline bool parseNumber(const std::string& text, double* value) {
  const std::string word = boost::trim_copy(text);
  // strtod also takes nan, inf and hexadecimal; their letters are kept out here.
  if (word.empty() || word.find_first_not_of("+-.0123456789eE") != std::string::npos) return false;
  // A program that is embedded in another one may have a locale with a decimal comma.
  static const locale_t kClassic = ::newlocale(LC_ALL_MASK, "C", nullptr);
  char* end = nullptr;
  const double number = ::strtod_l(word.c_str(), &end, kClassic);
  if (*end != '\0' || !std::isfinite(number)) return false;
  *value = number;
  return true;
}

}  // namespace ddm
