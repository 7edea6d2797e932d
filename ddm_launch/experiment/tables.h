// Tables of an experiment: the text of CSV files, and the files that are read back.
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

/// The text of a cell. Numbers have all digits, an empty optional is an empty cell, and each entry of
/// a list is a cell.
/// @throws std::range_error if a number is not finite, because the readers below would refuse it
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

/// z_1, z_2, ... of a feature, or NAME_1, NAME_2, ...
std::vector<std::string> featureNames(int feature_dim, const std::string& name = "z");

/// torques.csv: the torques of a run, and which of them were exploratory.
struct TorqueRows {
  std::vector<Eigen::VectorXd> torques;
  std::vector<bool> exploratory;  ///< as many
};

/// Header and one row per step.
/// @param names  of the torques
/// @throws std::invalid_argument if a row has another number of torques
std::string formatTorquesCsv(const TorqueRows& rows, const std::vector<std::string>& names);

/// trajectory.csv: header and the true state at each image.
/// @param times   since the first image [s]
/// @param states  as many
/// @param names   of the components of a state, with units
std::string formatTrajectoryCsv(const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& states,
                                const std::vector<std::string>& names);

/// trials.csv: header and one row per finished trial. success, success_strict and final_error are
/// empty where they are not known, v_r and v_p where the method has no such errors, return where the
/// plant has no reward. final_error is in the unit goal/error_unit of config.yaml.
std::string formatTrialsCsv(const std::vector<TrialRow>& rows);

/// The inverse functions, digit by digit. States are the columns of a matrix [names.size() x images].
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault
TorqueRows parseTorquesCsv(const std::string& text, const std::vector<std::string>& names,
                           const std::string& source);
Eigen::MatrixXd parseTrajectoryCsv(const std::string& text, const std::vector<std::string>& names,
                                   const std::string& source);
std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source);

/// Line k of .trials.crc32 is the CRC-32 of trials.csv as it was with k rows, k = 1, 2, ...
/// Therefore the checksums may be written before the table: if the program ends between, the table
/// still has its line.
std::string formatTrialsChecksums(const std::vector<TrialRow>& rows);

}  // namespace ddm
