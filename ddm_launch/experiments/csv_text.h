// Headers and numbers of CSV files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm {

/// "FIRST,NAME,NAME..."
std::string csvHeader(const std::string& first, const std::vector<std::string>& names);

/// ",VALUE,VALUE..." with all digits.
std::string csvValues(const Eigen::VectorXd& row);

/// z_1, z_2, ...
std::vector<std::string> featureNames(int feature_dim);

}  // namespace ddm
