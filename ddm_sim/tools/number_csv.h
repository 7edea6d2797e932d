// Reads numbers from the command line and from CSV text on the standard input of a program.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_value.h>
#include <ddm_common/yaml_text.h>

#include <Eigen/Core>
#include <boost/algorithm/string.hpp>
#include <istream>
#include <stdexcept>
#include <string>
#include <vector>

namespace ddm {

/// Parses finite decimal numbers, separated by commas, by parseNumber().
/// @return false, with `values` unchanged, if the text does not consist of exactly `count` numbers
inline bool parseNumbers(const std::string& text, Eigen::Index count, Eigen::VectorXd* values) {
  std::vector<std::string> words;
  boost::split(words, text, boost::is_any_of(","));
  if (static_cast<Eigen::Index>(words.size()) != count) return false;
  Eigen::VectorXd numbers(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!parseNumber(words[i], &numbers[i])) return false;
  }
  *values = numbers;
  return true;
}

/// Reads the standard input of a program: a header, then one row of finite numbers per line. Lines
/// may end in CR LF. Empty lines at the end are ignored.
/// @param names  names of the columns; the header must consist of these names, separated by commas
/// @param what   description of a row for error messages: "a torque"
/// @return rows, each [names.size() x 1]                                   [lines after the header]
/// @throws std::runtime_error with the line number, the content of the line and the rule
inline std::vector<Eigen::VectorXd> readNumbers(std::istream& input,
                                                const std::vector<std::string>& names,
                                                const std::string& what) {
  const auto size = static_cast<Eigen::Index>(names.size());
  const std::string header = boost::join(names, ",");
  const std::string rule = what + " must be " + std::to_string(size) +
                           (size == 1 ? " finite number (" : " finite numbers (") + header + ")";
  const auto fail = [](std::size_t line, const std::string& must, const std::string& got) {
    throw std::runtime_error("standard input, line " + std::to_string(line) + ": " + must +
                             ", got \"" + (got.empty() ? "" : oneLine(YAML::Node(got))) + "\"");
  };
  std::string text;
  std::getline(input, text);
  boost::trim(text);
  if (text != header) fail(1, "must be the header " + header, text);
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t line = 2; std::getline(input, text); ++line) {
    boost::trim(text);
    if (text.empty() && (input >> std::ws).eof()) break;  // empty lines at the end are ignored
    Eigen::VectorXd row;
    if (!parseNumbers(text, size, &row)) fail(line, rule, text);
    rows.push_back(row);
  }
  if (input.bad()) throw std::runtime_error("standard input cannot be read to its end");
  return rows;
}

}  // namespace ddm
