// Headers and numbers of CSV files.
// SPDX-License-Identifier: BSD-3-Clause
#include "csv_text.h"

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/lexical_cast.hpp>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

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

void parseCsv(const std::string& text, const std::string& header, const std::string& source,
              const std::function<void(const std::vector<std::string>& cells)>& take) {
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line != header) {
    throw std::runtime_error(source + ", line 1: must be " + header);
  }
  const auto num_columns = std::count(header.begin(), header.end(), ',') + 1;
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      std::vector<std::string> cells;
      boost::split(cells, line, boost::is_any_of(","));
      if (static_cast<std::ptrdiff_t>(cells.size()) != num_columns) {
        throw std::runtime_error("has " + std::to_string(cells.size()) + " columns, " +
                                 std::to_string(num_columns) + " are due");
      }
      if (in.eof()) throw std::runtime_error("has no end: the file is cut short");
      take(cells);
    } catch (const std::exception& e) {
      throw std::runtime_error(source + ", line " + std::to_string(number) + ": " + e.what());
    }
  }
}

double csvNumber(const std::string& cell) {
  double value = 0.0;
  if (!boost::conversion::try_lexical_convert(cell, value)) {
    throw std::runtime_error("'" + cell + "' is no number");
  }
  if (!std::isfinite(value)) throw std::runtime_error("'" + cell + "' is not finite");
  return value;
}

std::vector<std::string> featureNames(int feature_dim) {
  std::vector<std::string> names;
  for (int i = 1; i <= feature_dim; ++i) names.push_back("z_" + std::to_string(i));
  return names;
}

}  // namespace ddm
