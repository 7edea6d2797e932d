// Headers and numbers of CSV files.
// SPDX-License-Identifier: BSD-3-Clause
#include "csv_text.h"

#include <cstdio>

namespace ddm {

std::string csvHeader(const std::string& first, const std::vector<std::string>& names) {
  std::string text = first;
  for (const std::string& name : names) text += "," + name;
  return text;
}

std::string csvValues(const Eigen::VectorXd& row) {
  std::string text;
  for (Eigen::Index i = 0; i < row.size(); ++i) {
    char value[32];
    std::snprintf(value, sizeof(value), ",%.17g", row[i]);
    text += value;
  }
  return text;
}

std::vector<std::string> featureNames(int feature_dim) {
  std::vector<std::string> names;
  for (int i = 1; i <= feature_dim; ++i) names.push_back("z_" + std::to_string(i));
  return names;
}

}  // namespace ddm
