// Headers and numbers of CSV files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace ddm {

/// "FIRST,NAME,NAME..."
std::string csvHeader(const std::string& first, const std::vector<std::string>& names);

/// ",VALUE,VALUE..." with all digits.
std::string csvValues(const Eigen::VectorXd& row);

/// Calls `take` with the cells of each line after the header.
/// @param source  file, for messages
/// @throws std::runtime_error with source, line and fault, also for what `take` throws: another
///         header, another number of cells than in the header, a last line without its end
void parseCsv(const std::string& text, const std::string& header, const std::string& source,
              const std::function<void(const std::vector<std::string>& cells)>& take);

/// @throws std::runtime_error if a cell is no finite number
double csvNumber(const std::string& cell);

/// z_1, z_2, ...
std::vector<std::string> featureNames(int feature_dim);

}  // namespace ddm
