// Single values of a configuration: strict parsing, exact printing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {

/// The shortest text of a number that reads back as the same double: 0.2, 6.0, 1.0e-05, .nan. It
/// always has a point, because rosparam takes `1e-05` for a string and `6` for an integer.
std::string formatDouble(double value);

/// Conversions of one YAML value. Each returns false, and leaves `value` alone, where the text does
/// not have the type: 15.5 and 010 are no int, 0x10 is no double, `yes` is no bool. A quoted number
/// is a number. .inf and .nan are doubles: it is the options' business to refuse them. A list of
/// numbers with one entry may be the bare number.
bool parseValue(const YAML::Node& node, int* value);
bool parseValue(const YAML::Node& node, double* value);
bool parseValue(const YAML::Node& node, bool* value);
bool parseValue(const YAML::Node& node, std::string* value);
bool parseValue(const YAML::Node& node, std::vector<int>* value);
bool parseValue(const YAML::Node& node, std::vector<double>* value);
bool parseValue(const YAML::Node& node, std::vector<std::string>* value);
bool parseValue(const YAML::Node& node, std::vector<std::vector<double>>* value);

/// What a value of this type must be, to end the sentence "key must be ...".
const char* expectedType(const int*);
const char* expectedType(const double*);
const char* expectedType(const bool*);
const char* expectedType(const std::string*);
const char* expectedType(const std::vector<int>*);
const char* expectedType(const std::vector<double>*);
const char* expectedType(const std::vector<std::string>*);
const char* expectedType(const std::vector<std::vector<double>>*);

/// One value as YAML; lists in flow style, a list of numbers with one entry as the number.
/// parseValue() reads back exactly the same.
YAML::Node valueToYaml(int value);
YAML::Node valueToYaml(double value);
YAML::Node valueToYaml(bool value);
YAML::Node valueToYaml(const std::string& value);
YAML::Node valueToYaml(const std::vector<int>& value);
YAML::Node valueToYaml(const std::vector<double>& value);
YAML::Node valueToYaml(const std::vector<std::string>& value);
YAML::Node valueToYaml(const std::vector<std::vector<double>>& value);

}  // namespace ddm
