// Numbers on the command line and on the standard input of a tool: CSV text.
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

/// Finite decimal numbers with commas between them; each as parseNumber() takes it.
/// @return false, with `values` unchanged, if there are not exactly `count` or one is anything else
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

/// The standard input of a tool: a header, then a row of finite numbers in each line. Lines may end
/// in CR LF, and empty lines at the end do not count.
/// @param names  of the columns; joined by commas, the header that must stand there
/// @param what   a row is, "a torque", for messages
/// @return rows, each [names.size() x 1]                                [lines after the header]
/// @throws std::runtime_error with the number of the line, what stands there and the rule
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
    if (text.empty() && (input >> std::ws).eof()) break;  // empty lines at the end
    Eigen::VectorXd row;
    if (!parseNumbers(text, size, &row)) fail(line, rule, text);
    rows.push_back(row);
  }
  if (input.bad()) throw std::runtime_error("standard input cannot be read to its end");
  return rows;
}

}  // namespace ddm
