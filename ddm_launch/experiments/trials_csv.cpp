// trials.csv: one row per finished trial.
// SPDX-License-Identifier: BSD-3-Clause
#include "trials_csv.h"

#include <ddm_msgs/param_value.h>

#include <boost/algorithm/string.hpp>
#include <boost/lexical_cast.hpp>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

constexpr char kHeader[] =
    "seed,trial,frames,success,success_strict,final_error_deg,v_r,v_p,train_s,train_evaluations,"
    "plan_ms_median,plan_ms_p99";
constexpr size_t kNumColumns = 12;

std::string milliseconds(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3f", value);
  return text;
}

double number(const std::string& text) {
  const auto value = boost::lexical_cast<double>(text);
  if (!std::isfinite(value)) throw std::runtime_error("'" + text + "' is not finite");
  return value;
}

/// lexical_cast alone would make a huge number of "-1".
std::uint32_t count(const std::string& text) {
  if (text.empty() || text[0] == '-') throw std::runtime_error("'" + text + "' must be >= 0");
  return boost::lexical_cast<std::uint32_t>(text);
}

bool flag(const std::string& text) {
  if (text != "0" && text != "1") throw std::runtime_error("'" + text + "' must be 0 or 1");
  return text == "1";
}

std::optional<double> optionalNumber(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return number(text);
}

std::string format(const std::optional<double>& value) { return value ? formatDouble(*value) : ""; }

TrialRow parseRow(const std::string& line) {
  std::vector<std::string> columns;
  boost::split(columns, line, boost::is_any_of(","));
  if (columns.size() != kNumColumns) {
    throw std::runtime_error("has " + std::to_string(columns.size()) + " columns, " +
                             std::to_string(kNumColumns) + " are due");
  }
  TrialRow row;
  row.seed = boost::lexical_cast<int>(columns[0]);
  row.trial = boost::lexical_cast<int>(columns[1]);
  row.frames = count(columns[2]);
  row.evaluation.known = !columns[3].empty();
  if (row.evaluation.known) {
    row.evaluation.success = flag(columns[3]);
    row.evaluation.success_strict = flag(columns[4]);
    row.evaluation.final_error_deg = optionalNumber(columns[5]);
  }
  row.v_r = optionalNumber(columns[6]);
  row.v_p = optionalNumber(columns[7]);
  if (row.v_r.has_value() != row.v_p.has_value()) {
    throw std::runtime_error("v_r and v_p must be both empty or both given");
  }
  row.train_s = number(columns[8]);
  row.train_evaluations = count(columns[9]);
  row.plan_ms_median = number(columns[10]);
  row.plan_ms_p99 = number(columns[11]);
  return row;
}

}  // namespace

std::string formatTrialsCsv(const std::vector<TrialRow>& rows) {
  std::ostringstream out;
  out << kHeader << "\n";
  for (const TrialRow& row : rows) {
    out << row.seed << "," << row.trial << "," << row.frames << ",";
    if (row.evaluation.known) {
      out << row.evaluation.success << "," << row.evaluation.success_strict << ","
          << format(row.evaluation.final_error_deg);
    } else {
      out << ",,";
    }
    out << "," << format(row.v_r) << "," << format(row.v_p) << "," << milliseconds(row.train_s)
        << "," << row.train_evaluations << "," << milliseconds(row.plan_ms_median) << ","
        << milliseconds(row.plan_ms_p99) << "\n";
  }
  return out.str();
}

std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source) {
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line != kHeader) {
    throw std::runtime_error(source + ", line 1: must be " + kHeader);
  }
  std::vector<TrialRow> rows;
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      rows.push_back(parseRow(line));
    } catch (const std::exception& e) {
      throw std::runtime_error(source + ", line " + std::to_string(number) + ": " + e.what());
    }
  }
  return rows;
}

}  // namespace ddm
