// Writes and reads the CSV files of an experiment.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "evaluation.h"

namespace ddm {

/// The text of a CSV cell. A number has enough digits to restore it exactly, an empty optional is
/// an empty cell, and a list becomes one cell per entry.
/// @throws std::range_error if a number is not finite, because the parsers below reject such
///         numbers
inline std::string csvCell(const std::string& text) { return text; }
std::string csvCell(double value);
std::string csvCell(const std::optional<double>& value);
std::string csvCell(const Eigen::VectorXd& values);
std::string csvCell(const std::vector<std::string>& names);
template <class Integer>
std::enable_if_t<std::is_integral<Integer>::value, std::string> csvCell(Integer value) {
  return std::to_string(value);
}

/// One line of a CSV file, "CELL,CELL,...\n": a header or a row.
template <class... Cells>
std::string csvLine(const Cells&... cells) {
  std::string line;
  for (const std::string& cell : {csvCell(cells)...}) line += cell + ",";
  line.back() = '\n';
  return line;
}

/// Column names of a feature: z_1, z_2, ... or NAME_1, NAME_2, ...
std::vector<std::string> featureNames(int feature_dim, const std::string& name = "z");

/// The text of torques.csv: a header and one row per step.
/// @param torques      N vectors [N m]
/// @param exploratory  N flags, true for a random torque
/// @param names        names of the torques, with units
/// @throws std::invalid_argument if a row does not have one torque per name
std::string formatTorquesCsv(const std::vector<Eigen::VectorXd>& torques,
                             const std::vector<bool>& exploratory,
                             const std::vector<std::string>& names);

/// The text of trajectory.csv: a header and the true state at each of N images.
/// @param times   N times since the first image [s]
/// @param states  N states
/// @param names   names of the components of a state, with units
std::string formatTrajectoryCsv(const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& states,
                                const std::vector<std::string>& names);

/// The text of trials.csv: a header and one row per finished trial. The columns success,
/// success_strict and final_error are empty if the result is unknown, v_r and v_p if the method has
/// no such errors, and return if the plant has no reward. The unit of final_error is
/// goal/error_unit in config.yaml.
std::string formatTrialsCsv(const std::vector<TrialRow>& rows);

/// Inverse functions of the two functions above. The states are the columns of a matrix
/// [names.size() x N].
/// @param source  path of the file, for error messages
/// @throws std::runtime_error with source, line and reason
Eigen::MatrixXd parseTrajectoryCsv(const std::string& text, const std::vector<std::string>& names,
                                   const std::string& source);
std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source);

/// The text of .trials.crc32: line k is the CRC-32 of trials.csv with its first k rows, k = 1, 2,
/// ... The checksums can therefore be written before the table: if the program is killed in
/// between, the shorter table still matches one of the lines.
std::string formatTrialsChecksums(const std::vector<TrialRow>& rows);

}  // namespace ddm
