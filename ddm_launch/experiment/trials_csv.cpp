// trials.csv: one row per finished trial.
// SPDX-License-Identifier: BSD-3-Clause
#include "trials_csv.h"

#include <ddm_params/param_value.h>

#include <boost/lexical_cast.hpp>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

constexpr char kHeader[] =
    "seed,trial,frames,success,success_strict,final_error,v_r,v_p,train_s,train_evaluations,"
    "plan_ms_median,plan_ms_p99,version,return";

/// Headers of older versions, and the cells that their rows lack.
struct OldTable {
  const char* header;
  const char* missing_cells;
};
constexpr OldTable kOldTables[] = {
    {"seed,trial,frames,success,success_strict,final_error_deg,v_r,v_p,train_s,train_evaluations,"
     "plan_ms_median,plan_ms_p99,version",
     ","},
    {"seed,trial,frames,success,success_strict,final_error_deg,v_r,v_p,train_s,train_evaluations,"
     "plan_ms_median,plan_ms_p99",
     ",?,"}};

std::string milliseconds(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3f", value);
  return text;
}

/// lexical_cast alone would make a huge number of "-1".
std::uint32_t count(const std::string& text) {
  if (text.empty() || text[0] == '-') throw std::runtime_error("'" + text + "' must be >= 0");
  return boost::lexical_cast<std::uint32_t>(text);
}

/// A time, which is written with three decimals.
double duration(const std::string& text) {
  const double value = csvNumber(text);
  if (value < 0.0 || value > 1e12) throw std::runtime_error("'" + text + "' is no duration");
  return value;
}

bool flag(const std::string& text) {
  if (text != "0" && text != "1") throw std::runtime_error("'" + text + "' must be 0 or 1");
  return text == "1";
}

std::optional<double> optionalNumber(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return csvNumber(text);
}

std::string format(const std::optional<double>& value) { return value ? formatDouble(*value) : ""; }

TrialRow parseRow(const std::vector<std::string>& columns) {
  TrialRow row;
  row.seed = boost::lexical_cast<int>(columns[0]);
  row.trial = boost::lexical_cast<int>(columns[1]);
  row.frames = count(columns[2]);
  row.evaluation.known = !columns[3].empty();
  if (row.evaluation.known) {
    row.evaluation.success = flag(columns[3]);
    row.evaluation.success_strict = flag(columns[4]);
    row.evaluation.final_error = optionalNumber(columns[5]);
    row.evaluation.total_reward = optionalNumber(columns[13]);
  } else if (!columns[4].empty() || !columns[5].empty() || !columns[13].empty()) {
    throw std::runtime_error(
        "success_strict, final_error and return must be empty where success is");
  }
  row.v_r = optionalNumber(columns[6]);
  row.v_p = optionalNumber(columns[7]);
  if (row.v_r.has_value() != row.v_p.has_value()) {
    throw std::runtime_error("v_r and v_p must be both empty or both given");
  }
  row.train_s = duration(columns[8]);
  row.train_evaluations = count(columns[9]);
  row.plan_ms_median = duration(columns[10]);
  row.plan_ms_p99 = duration(columns[11]);
  row.version = columns[12];
  if (row.version.empty()) throw std::runtime_error("version must not be empty; unknown is ?");
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
          << format(row.evaluation.final_error);
    } else {
      out << ",,";
    }
    out << "," << format(row.v_r) << "," << format(row.v_p) << "," << milliseconds(row.train_s)
        << "," << row.train_evaluations << "," << milliseconds(row.plan_ms_median) << ","
        << milliseconds(row.plan_ms_p99) << "," << row.version << ","
        << format(row.evaluation.total_reward) << "\n";
  }
  return out.str();
}

std::string inTodaysColumns(const std::string& text) {
  for (const OldTable& old : kOldTables) {
    const std::string old_header = std::string(old.header) + "\n";
    if (text.compare(0, old_header.size(), old_header) != 0) continue;
    std::string out = std::string(kHeader) + "\n";
    for (size_t i = old_header.size(); i < text.size(); ++i) {
      if (text[i] == '\n') out += old.missing_cells;
      out += text[i];
    }
    return out;
  }
  return text;
}

std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source) {
  std::vector<TrialRow> rows;
  parseCsv(inTodaysColumns(text), kHeader, source,
           [&rows](const std::vector<std::string>& cells) { rows.push_back(parseRow(cells)); });
  return rows;
}

}  // namespace ddm
