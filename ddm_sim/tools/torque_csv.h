// Reads torques from CSV text, and numbers from words.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <istream>
#include <string>
#include <vector>

namespace ddm {

/// A finite decimal number and nothing else: no hexadecimal, no nan, no inf, no unit behind it.
/// Blanks around it are allowed.
/// @return false, with `value` unchanged, if `text` is anything else
bool parseNumber(const std::string& text, double* value);

/// Finite decimal numbers with commas between them; each as parseNumber() takes it.
/// @return false, with `values` unchanged, if there are not exactly `count` or one is anything else
bool parseNumbers(const std::string& text, Eigen::Index count, Eigen::VectorXd* values);

/// `words` with commas between them, as a header has them.
std::string joinedByCommas(const std::vector<std::string>& words);

/// Torques of a run: a header, then one torque a line. Lines may end in CR LF, and empty lines at
/// the end do not count.
/// @param names  of the components; joined by commas, the header that must stand there
/// @return torques, each [names.size() x 1]                             [lines after the header]
/// @throws std::runtime_error with the number of the line, what stands there and the rule
std::vector<Eigen::VectorXd> readTorques(std::istream& input,
                                         const std::vector<std::string>& names);

}  // namespace ddm
