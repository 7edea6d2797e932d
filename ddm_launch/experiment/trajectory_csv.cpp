// trajectory.csv: the plant's true state at each frame of a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_csv.h"

#include <cstdio>
#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

constexpr char kFirst[] = "step,time_s";

Eigen::VectorXd parseRow(const std::vector<std::string>& cells, size_t step) {
  if (cells[0] != std::to_string(step)) {
    throw std::runtime_error("must be step " + std::to_string(step) + ", got " + cells[0]);
  }
  csvNumber(cells[1]);
  Eigen::VectorXd state(static_cast<Eigen::Index>(cells.size()) - 2);
  for (size_t i = 2; i < cells.size(); ++i) {
    state[static_cast<Eigen::Index>(i) - 2] = csvNumber(cells[i]);
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
  std::vector<Eigen::VectorXd> rows;
  parseCsv(text, csvHeader(kFirst, names), source, [&rows](const std::vector<std::string>& cells) {
    rows.push_back(parseRow(cells, rows.size()));
  });
  Eigen::MatrixXd states(static_cast<Eigen::Index>(names.size()),
                         static_cast<Eigen::Index>(rows.size()));
  for (size_t step = 0; step < rows.size(); ++step) {
    states.col(static_cast<Eigen::Index>(step)) = rows[step];
  }
  return states;
}

}  // namespace ddm
