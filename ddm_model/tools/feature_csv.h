// Reads features from CSV text.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <istream>
#include <vector>

namespace ddm {

/// Features as they are on the standard input of a tool: the header z_1,z_2,..., then one feature a
/// line. Blank lines at the end do not count.
/// @return z  [feature_dim] for each line after the header
/// @throws std::runtime_error with the number of the line, what stands there and the rule
std::vector<Eigen::VectorXd> readFeatures(std::istream& input, int feature_dim);

}  // namespace ddm
