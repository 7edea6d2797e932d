// trajectory.csv: the plant's true state at each frame of a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_csv.h"

#include <boost/algorithm/string.hpp>
#include <boost/lexical_cast.hpp>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

constexpr char kFirst[] = "step,time_s";

Eigen::VectorXd parseRow(const std::string& line, int step, size_t num_names) {
  std::vector<std::string> columns;
  boost::split(columns, line, boost::is_any_of(","));
  if (columns.size() != num_names + 2) {
    throw std::runtime_error("has " + std::to_string(columns.size()) + " columns, " +
                             std::to_string(num_names + 2) + " are due");
  }
  if (columns[0] != std::to_string(step)) {
    throw std::runtime_error("must be step " + std::to_string(step) + ", got " + columns[0]);
  }
  Eigen::VectorXd state(static_cast<Eigen::Index>(num_names));
  for (size_t i = 0; i < num_names; ++i) {
    const auto value = boost::lexical_cast<double>(columns[i + 2]);
    if (!std::isfinite(value)) throw std::runtime_error("'" + columns[i + 2] + "' is not finite");
    state[static_cast<Eigen::Index>(i)] = value;
  }
  return state;
}

}  // namespace

std::string formatTrajectoryCsv(const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& states,
                                const std::vector<std::string>& names) {
  std::string text = csvHeader(kFirst, names) + "\n";
  for (size_t step = 0; step < states.size(); ++step) {
    char time[32];
    std::snprintf(time, sizeof(time), ",%.9g", times[step]);
    text += std::to_string(step) + time + csvValues(states[step]) + "\n";
  }
  return text;
}

Eigen::MatrixXd parseTrajectoryCsv(const std::string& text, const std::vector<std::string>& names,
                                   const std::string& source) {
  const std::string header = csvHeader(kFirst, names);
  std::istringstream in(text);
  std::string line;
  if (!std::getline(in, line) || line != header) {
    throw std::runtime_error(source + ", line 1: must be " + header);
  }
  std::vector<Eigen::VectorXd> rows;
  while (std::getline(in, line)) {
    const int step = static_cast<int>(rows.size());
    try {
      rows.push_back(parseRow(line, step, names.size()));
    } catch (const std::exception& e) {
      throw std::runtime_error(source + ", line " + std::to_string(step + 2) + ": " + e.what());
    }
  }
  Eigen::MatrixXd states(static_cast<Eigen::Index>(names.size()),
                         static_cast<Eigen::Index>(rows.size()));
  for (size_t step = 0; step < rows.size(); ++step) {
    states.col(static_cast<Eigen::Index>(step)) = rows[step];
  }
  return states;
}

}  // namespace ddm
