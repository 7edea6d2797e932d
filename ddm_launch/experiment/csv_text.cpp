// Lines and cells of CSV files.
// SPDX-License-Identifier: BSD-3-Clause
#include "csv_text.h"

#include <ddm_common/param_value.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/lexical_cast.hpp>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace ddm {

namespace {

void requireFinite(double value) {
  if (std::isfinite(value)) return;
  throw std::range_error("a number of a table must be finite, got " + formatDouble(value) +
                         ": nothing is written");
}

}  // namespace

std::string csvCell(double value) {
  requireFinite(value);
  return formatDouble(value);
}

std::string csvCell(const std::optional<double>& value) { return value ? csvCell(*value) : ""; }

std::string csvCell(const Eigen::VectorXd& values) {
  std::ostringstream text;
  text.precision(17);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    requireFinite(values[i]);
    text << (i == 0 ? "" : ",") << values[i];
  }
  return text.str();
}

std::string csvCell(const std::vector<std::string>& names) { return boost::join(names, ","); }

void parseCsv(const std::string& text, const std::string& header, const std::string& source,
              const std::function<void(const std::vector<std::string>& cells)>& take) {
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line + "\n" != header) {
    throw std::runtime_error(source + ", line 1: must be " + boost::trim_right_copy(header));
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
    throw std::runtime_error("'" + cell + "' is not a number");
  }
  if (!std::isfinite(value)) throw std::runtime_error("'" + cell + "' is not finite");
  return value;
}

bool csvFlag(const std::string& cell) {
  if (cell != "0" && cell != "1") throw std::runtime_error("'" + cell + "' must be 0 or 1");
  return cell == "1";
}

std::vector<std::string> featureNames(int feature_dim, const std::string& name) {
  std::vector<std::string> names;
  for (int i = 1; i <= feature_dim; ++i) names.push_back(name + "_" + std::to_string(i));
  return names;
}

}  // namespace ddm
