// Reads torques from CSV text, and numbers from words.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <istream>
#include <string>
#include <vector>

namespace ddm {

/// A finite decimal number and nothing else: no hexadecimal, no nan, no inf, no unit behind it.
/// Blanks around it are allowed.
/// @return false, with `value` unchanged, if `text` is anything else
bool parseNumber(const std::string& text, double* value);

/// Torques of a run: the header `torque_nm`, then one value a line. Lines may end in CR LF, and
/// empty lines at the end do not count.
/// @return torques [N m]                                            [lines after the header]
/// @throws std::runtime_error with the number of the line, what stands there and the rule
std::vector<double> readTorques(std::istream& input);

}  // namespace ddm
