// Conversion of single configuration values: strict parsing and exact printing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <utility>
#include <vector>

namespace ddm {

/// Returns the shortest text that reads back as the same double: 0.2, 6.0, 1.0e-05, .nan. The text
/// always has a decimal point, because rosparam reads `1e-05` as a string and `6` as an integer.
std::string formatDouble(double value);

/// Parse one YAML value. Each function returns false and leaves `value` unchanged if the text does
/// not have the type: 15.5 and 010 are no int, 0x10 is no double, `yes` is no bool. A quoted number
/// is a number. .inf and .nan are doubles, and the options struct decides whether to refuse them. A
/// list of numbers with one entry may be written as a bare number.
bool parseValue(const YAML::Node& node, int* value);
bool parseValue(const YAML::Node& node, double* value);
bool parseValue(const YAML::Node& node, bool* value);
bool parseValue(const YAML::Node& node, std::string* value);
bool parseValue(const YAML::Node& node, std::vector<double>* value);
template <class Value>
bool parseValue(const YAML::Node& node, std::vector<Value>* value) {
  if (!node.IsSequence()) return false;
  std::vector<Value> parsed;
  for (const YAML::Node& element : node) {
    Value entry{};
    if (!parseValue(element, &entry)) return false;
    parsed.push_back(entry);
  }
  *value = std::move(parsed);
  return true;
}

/// Parses a finite decimal number of a command line or a CSV file, without a unit. Blanks around
/// the number are allowed. Returns false and leaves `value` unchanged for any other text.
bool parseNumber(const std::string& text, double* value);

/// Describes the type of a value; completes the sentence "key must be ...".
inline std::string expectedType(const int*) { return "an integer (32 bit)"; }
inline std::string expectedType(const double*) { return "a number"; }
inline std::string expectedType(const bool*) { return "true or false"; }
inline std::string expectedType(const std::string*) { return "a text"; }
inline std::string expectedType(const std::vector<double>*) {
  return "a number or a list of numbers";
}
template <class Value>
std::string expectedType(const std::vector<Value>*) {
  return "a list, each entry " + expectedType(static_cast<const Value*>(nullptr));
}

/// Convert a value to YAML. Lists are written in flow style, and a list of numbers with one entry
/// is written as the number. parseValue() reads the same value back.
YAML::Node valueToYaml(int value);
YAML::Node valueToYaml(double value);
YAML::Node valueToYaml(bool value);
YAML::Node valueToYaml(const std::string& value);
YAML::Node valueToYaml(const std::vector<double>& value);
template <class Value>
YAML::Node valueToYaml(const std::vector<Value>& values) {
  YAML::Node out(YAML::NodeType::Sequence);
  for (const Value& value : values) out.push_back(valueToYaml(value));
  out.SetStyle(YAML::EmitterStyle::Flow);
  return out;
}

}  // namespace ddm
