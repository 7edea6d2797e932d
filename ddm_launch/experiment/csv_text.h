// Lines and cells of CSV files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace ddm {

/// The text of a cell. Numbers have all digits, an empty optional is an empty cell, and of a list
/// each entry is a cell.
/// @throws std::range_error if a number is not finite, since csvNumber() would refuse it
inline std::string csvCell(const std::string& text) { return text; }
std::string csvCell(double value);
std::string csvCell(const std::optional<double>& value);
std::string csvCell(const Eigen::VectorXd& values);
std::string csvCell(const std::vector<std::string>& names);
template <class Integer>
std::enable_if_t<std::is_integral<Integer>::value, std::string> csvCell(Integer value) {
  return std::to_string(value);
}

/// "CELL,CELL,...\n", a header or a row.
template <class... Cells>
std::string csvLine(const Cells&... cells) {
  std::string line;
  for (const std::string& cell : {csvCell(cells)...}) line += cell + ",";
  line.back() = '\n';
  return line;
}

/// Calls `take` with the cells of each line after the header.
/// @param header  as csvLine() writes it
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault, also for what `take` throws: another
///         header, another number of cells than in the header, a last line without its end
void parseCsv(const std::string& text, const std::string& header, const std::string& source,
              const std::function<void(const std::vector<std::string>& cells)>& take);

/// @throws std::runtime_error if a cell is no finite number
double csvNumber(const std::string& cell);

/// @throws std::runtime_error if a cell is neither 0 nor 1
bool csvFlag(const std::string& cell);

/// z_1, z_2, ... of a feature, or NAME_1, NAME_2, ...
std::vector<std::string> featureNames(int feature_dim, const std::string& name = "z");

}  // namespace ddm
