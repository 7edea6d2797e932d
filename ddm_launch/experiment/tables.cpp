// Writes and reads the CSV files of an experiment.
// SPDX-License-Identifier: BSD-3-Clause
#include "tables.h"

#include <ddm_common/param_value.h>
#include <ddm_model/model_file.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/format.hpp>
#include <boost/lexical_cast.hpp>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace {

using Cells = std::vector<std::string>;

constexpr char kTrialsHeader[] =
    "seed,trial,frames,success,success_strict,final_error,v_r,v_p,train_s,train_evaluations,"
    "plan_ms_median,plan_ms_p99,version,return\n";

void requireFinite(double value) {
  if (std::isfinite(value)) return;
  throw std::range_error("a number of a table must be finite, got " + formatDouble(value) +
                         ": nothing is written");
}

/// Calls `take` with the cells of each line after the header.
/// @param header  expected first line, in the format of csvLine()
/// @param source  path of the file, for error messages
/// @throws std::runtime_error with source, line and reason if the header differs, if a row has
///         another number of cells than the header, if the last line has no line end, or if `take`
///         throws
void parseCsv(const std::string& text, const std::string& header, const std::string& source,
              const std::function<void(const Cells& cells)>& take) {
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line + "\n" != header) {
    throw std::runtime_error(source + ", line 1: must be " + boost::trim_right_copy(header));
  }
  const auto num_columns = std::count(header.begin(), header.end(), ',') + 1;
  for (int number = 2; std::getline(in, line); ++number) {
    try {
      Cells cells;
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

double finiteNumber(const std::string& cell) {
  double value = 0.0;
  if (!boost::conversion::try_lexical_convert(cell, value)) {
    throw std::runtime_error("'" + cell + "' is not a number");
  }
  if (!std::isfinite(value)) throw std::runtime_error("'" + cell + "' is not finite");
  return value;
}

std::optional<double> optionalNumber(const std::string& cell) {
  if (cell.empty()) return std::nullopt;
  return finiteNumber(cell);
}

bool flag(const std::string& cell) {
  if (cell != "0" && cell != "1") throw std::runtime_error("'" + cell + "' must be 0 or 1");
  return cell == "1";
}

std::string trajectoryHeader(const Cells& names) { return csvLine("step", "time_s", names); }

std::string milliseconds(double value) { return boost::str(boost::format("%.3f") % value); }

/// Reads a row that formatTrialsCsv() has written. The checksums of RunFolder find any change.
TrialRow parseTrialRow(const Cells& cells) {
  TrialRow row;
  row.seed = boost::lexical_cast<int>(cells[0]);
  row.trial = boost::lexical_cast<int>(cells[1]);
  row.frames = boost::lexical_cast<std::uint32_t>(cells[2]);
  row.evaluation.known = !cells[3].empty();
  if (row.evaluation.known) {
    row.evaluation.success = flag(cells[3]);
    row.evaluation.success_strict = flag(cells[4]);
    row.evaluation.final_error = optionalNumber(cells[5]);
    row.evaluation.total_reward = optionalNumber(cells[13]);
  }
  row.v_r = optionalNumber(cells[6]);
  row.v_p = optionalNumber(cells[7]);
  row.train_s = finiteNumber(cells[8]);
  row.train_evaluations = boost::lexical_cast<std::uint32_t>(cells[9]);
  row.plan_ms_median = finiteNumber(cells[10]);
  row.plan_ms_p99 = finiteNumber(cells[11]);
  row.version = cells[12];
  return row;
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

std::vector<std::string> featureNames(int feature_dim, const std::string& name) {
  std::vector<std::string> names;
  for (int i = 1; i <= feature_dim; ++i) names.push_back(name + "_" + std::to_string(i));
  return names;
}

std::string formatTorquesCsv(const std::vector<Eigen::VectorXd>& torques,
                             const std::vector<bool>& exploratory,
                             const std::vector<std::string>& names) {
  std::string text = csvLine("step", names, "exploratory");
  for (std::size_t step = 0; step < torques.size(); ++step) {
    const auto size = static_cast<std::size_t>(torques[step].size());
    if (size != names.size()) {
      throw std::invalid_argument("torques.csv: step " + std::to_string(step) + " has " +
                                  std::to_string(size) + " torque(s), the header " +
                                  std::to_string(names.size()) + " (" + csvCell(names) +
                                  "): the plant or robot of the configuration is not the one that "
                                  "ran");
    }
    text += csvLine(step, torques[step], bool(exploratory[step]));
  }
  return text;
}

std::string formatTrajectoryCsv(const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& states,
                                const std::vector<std::string>& names) {
  std::string text = trajectoryHeader(names);
  for (std::size_t step = 0; step < states.size(); ++step) {
    text += csvLine(step, boost::str(boost::format("%.9g") % times[step]), states[step]);
  }
  return text;
}

std::string formatTrialsCsv(const std::vector<TrialRow>& rows) {
  std::string text = kTrialsHeader;
  for (const TrialRow& row : rows) {
    const Evaluation& evaluation = row.evaluation;
    const auto known = [&](bool value) { return evaluation.known ? csvCell(value) : ""; };
    text +=
        csvLine(row.seed, row.trial, row.frames, known(evaluation.success),
                known(evaluation.success_strict), evaluation.final_error, row.v_r, row.v_p,
                milliseconds(row.train_s), row.train_evaluations, milliseconds(row.plan_ms_median),
                milliseconds(row.plan_ms_p99), row.version, evaluation.total_reward);
  }
  return text;
}

Eigen::MatrixXd parseTrajectoryCsv(const std::string& text, const std::vector<std::string>& names,
                                   const std::string& source) {
  Eigen::MatrixXd states(static_cast<Eigen::Index>(names.size()), 0);
  parseCsv(text, trajectoryHeader(names), source, [&states](const Cells& cells) {
    const Eigen::Index step = states.cols();
    if (cells[0] != std::to_string(step)) {
      throw std::runtime_error("must be step " + std::to_string(step) + ", got " + cells[0]);
    }
    finiteNumber(cells[1]);
    states.conservativeResize(Eigen::NoChange, step + 1);
    for (Eigen::Index i = 0; i < states.rows(); ++i) {
      states(i, step) = finiteNumber(cells[static_cast<std::size_t>(i) + 2]);
    }
  });
  return states;
}

std::vector<TrialRow> parseTrialsCsv(const std::string& text, const std::string& source) {
  std::vector<TrialRow> rows;
  parseCsv(text, kTrialsHeader, source,
           [&rows](const Cells& cells) { rows.push_back(parseTrialRow(cells)); });
  return rows;
}

std::string formatTrialsChecksums(const std::vector<TrialRow>& rows) {
  std::string lines;
  for (auto end = rows.begin(); end != rows.end();) {
    lines += checksum(formatTrialsCsv({rows.begin(), ++end})) + "\n";
  }
  return lines;
}

}  // namespace ddm
