// trials.csv: one row per finished trial, and the checksums that show when it was changed.
// SPDX-License-Identifier: BSD-3-Clause
#include "trials_csv.h"

#include <ddm_model/model_file.h>

#include <boost/algorithm/string.hpp>
#include <boost/format.hpp>
#include <boost/lexical_cast.hpp>
#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

constexpr char kHeader[] =
    "seed,trial,frames,success,success_strict,final_error,v_r,v_p,train_s,train_evaluations,"
    "plan_ms_median,plan_ms_p99,version,return\n";

std::string milliseconds(double value) { return boost::str(boost::format("%.3f") % value); }

/// lexical_cast alone would make a huge number of "-1".
std::uint32_t count(const std::string& text) {
  if (text.empty() || text[0] == '-') throw std::runtime_error("'" + text + "' must be >= 0");
  return boost::lexical_cast<std::uint32_t>(text);
}

/// A time, which is written with three decimals.
double duration(const std::string& text) {
  const double value = csvNumber(text);
  if (value < 0.0 || value > 1e12) throw std::runtime_error("'" + text + "' is not a duration");
  return value;
}

std::optional<double> optionalNumber(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return csvNumber(text);
}

TrialRow parseRow(const std::vector<std::string>& columns) {
  TrialRow row;
  row.seed = boost::lexical_cast<int>(columns[0]);
  row.trial = boost::lexical_cast<int>(columns[1]);
  row.frames = count(columns[2]);
  row.evaluation.known = !columns[3].empty();
  if (row.evaluation.known) {
    row.evaluation.success = csvFlag(columns[3]);
    row.evaluation.success_strict = csvFlag(columns[4]);
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
  std::string text = kHeader;
  for (const TrialRow& row : rows) {
    const Evaluation& evaluation = row.evaluation;
    const auto flag = [&](bool value) { return evaluation.known ? csvCell(value) : ""; };
    text +=
        csvLine(row.seed, row.trial, row.frames, flag(evaluation.success),
                flag(evaluation.success_strict), evaluation.final_error, row.v_r, row.v_p,
                milliseconds(row.train_s), row.train_evaluations, milliseconds(row.plan_ms_median),
                milliseconds(row.plan_ms_p99), row.version, evaluation.total_reward);
  }
  return text;
}

std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source) {
  std::vector<TrialRow> rows;
  parseCsv(text, kHeader, source,
           [&rows](const std::vector<std::string>& cells) { rows.push_back(parseRow(cells)); });
  return rows;
}

std::string formatTrialsChecksums(const std::vector<TrialRow>& rows) {
  std::string lines;
  std::vector<TrialRow> first;
  for (const TrialRow& row : rows) {
    first.push_back(row);
    lines += checksum(formatTrialsCsv(first)) + "\n";
  }
  return lines;
}

bool isUnchanged(const std::string& trials_csv, size_t num_rows, const std::string& checksums) {
  std::vector<std::string> lines;
  boost::split(lines, checksums, boost::is_any_of("\n"));
  if (num_rows == 0) return true;
  return lines.size() >= num_rows && lines[num_rows - 1] == checksum(trials_csv);
}

}  // namespace ddm
