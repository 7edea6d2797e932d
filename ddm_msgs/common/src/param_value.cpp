// Conversion of single configuration values: strict parsing and exact printing.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/param_value.h"

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <limits>
#include <locale>
#include <sstream>

namespace ddm {
namespace {

constexpr int kExactDigits = std::numeric_limits<double>::max_digits10;

bool parseText(std::string text, int* value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  const std::size_t first_digit = !text.empty() && text[0] == '-' ? 1 : 0;
  // YAML readers disagree on a leading zero: some read an octal number and some a decimal number.
  if (text.size() > first_digit + 1 && text[first_digit] == '0') return false;
  int parsed = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return false;
  *value = parsed;
  return true;
}

bool parseText(const std::string& text, double* value) {
  const std::string unsigned_text = text.substr(text.find_first_not_of("+-") == 1 ? 1 : 0);
  const double sign = !text.empty() && text[0] == '-' ? -1.0 : 1.0;
  for (const char* infinite : {".inf", ".Inf", ".INF", "inf", "Infinity"}) {
    if (unsigned_text == infinite) {
      *value = sign * std::numeric_limits<double>::infinity();
      return true;
    }
  }
  for (const char* nan : {".nan", ".NaN", ".NAN", "nan", "NaN"}) {
    if (text == nan) {
      *value = std::numeric_limits<double>::quiet_NaN();
      return true;
    }
  }
  std::istringstream in(text);
  in.imbue(std::locale::classic());  // the locale of the program must not change the decimal point
  double parsed = 0.0;
  if (!(in >> std::noskipws >> parsed) || in.peek() != std::istringstream::traits_type::eof()) {
    return false;
  }
  *value = parsed;
  return true;
}

template <class Value>
bool parseScalar(const YAML::Node& node, Value* value) {
  return node.IsScalar() && parseText(node.Scalar(), value);
}

}  // namespace

std::string formatDouble(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  std::string text;
  for (int digits = kExactDigits - 2; digits <= kExactDigits; ++digits) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out << std::setprecision(digits) << value;
    text = out.str();
    double read_back = 0.0;
    if (parseText(text, &read_back) && read_back == value) break;
  }
  if (text.find('.') == std::string::npos) {
    text.insert(std::min(text.find('e'), text.size()), ".0");
  }
  return text;
}

bool parseNumber(const std::string& text, double* value) {
  double parsed = 0.0;
  if (!parseText(boost::trim_copy(text), &parsed) || !std::isfinite(parsed)) return false;
  *value = parsed;
  return true;
}

bool parseValue(const YAML::Node& node, int* value) { return parseScalar(node, value); }
bool parseValue(const YAML::Node& node, double* value) { return parseScalar(node, value); }

bool parseValue(const YAML::Node& node, bool* value) {
  if (!node.IsScalar() || (node.Scalar() != "true" && node.Scalar() != "false")) return false;
  *value = node.Scalar() == "true";
  return true;
}

bool parseValue(const YAML::Node& node, std::string* value) {
  if (!node.IsScalar()) return false;
  *value = node.Scalar();
  return true;
}

bool parseValue(const YAML::Node& node, std::vector<double>* value) {
  double number = 0.0;
  if (!parseScalar(node, &number)) return parseValue<double>(node, value);
  *value = {number};
  return true;
}

YAML::Node valueToYaml(int value) { return YAML::Node(std::to_string(value)); }
YAML::Node valueToYaml(double value) { return YAML::Node(formatDouble(value)); }
YAML::Node valueToYaml(bool value) { return YAML::Node(value ? "true" : "false"); }
YAML::Node valueToYaml(const std::string& value) { return YAML::Node(value); }
YAML::Node valueToYaml(const std::vector<double>& value) {
  return value.size() == 1 ? valueToYaml(value[0]) : valueToYaml<double>(value);
}

}  // namespace ddm
