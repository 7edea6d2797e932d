// torques.csv and trajectory.csv: torque and true state at each step of a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_csv.h"

#include <boost/format.hpp>
#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

std::string torquesHeader(const std::vector<std::string>& names) {
  return csvLine("step", names, "exploratory");
}

std::string trajectoryHeader(const std::vector<std::string>& names) {
  return csvLine("step", "time_s", names);
}

void requireStep(const std::string& cell, std::size_t step) {
  if (cell == std::to_string(step)) return;
  throw std::runtime_error("must be step " + std::to_string(step) + ", got " + cell);
}

/// The numbers in some cells of a row.
Eigen::VectorXd numbersOf(const std::vector<std::string>& cells, std::size_t begin,
                          std::size_t count) {
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    numbers[static_cast<Eigen::Index>(i)] = csvNumber(cells[begin + i]);
  }
  return numbers;
}

}  // namespace

std::string formatTorquesCsv(const TorqueRows& rows, const std::vector<std::string>& names) {
  std::string text = torquesHeader(names);
  for (std::size_t step = 0; step < rows.torques.size(); ++step) {
    const auto size = static_cast<std::size_t>(rows.torques[step].size());
    if (size != names.size()) {
      throw std::invalid_argument("torques.csv: step " + std::to_string(step) + " has " +
                                  std::to_string(size) + " torque(s), the header " +
                                  std::to_string(names.size()) + " (" + csvCell(names) +
                                  "): the plant or robot of the configuration is not the one that "
                                  "ran");
    }
    text += csvLine(step, rows.torques[step], bool(rows.exploratory[step]));
  }
  return text;
}

TorqueRows parseTorquesCsv(const std::string& text, const std::vector<std::string>& names,
                           const std::string& source) {
  TorqueRows rows;
  parseCsv(text, torquesHeader(names), source, [&](const std::vector<std::string>& cells) {
    requireStep(cells[0], rows.torques.size());
    rows.torques.push_back(numbersOf(cells, 1, names.size()));
    rows.exploratory.push_back(csvFlag(cells.back()));
  });
  return rows;
}

std::string formatTrajectoryCsv(const std::vector<double>& times,
                                const std::vector<Eigen::VectorXd>& states,
                                const std::vector<std::string>& names) {
  std::string text = trajectoryHeader(names);
  for (std::size_t step = 0; step < states.size(); ++step) {
    const std::string time = boost::str(boost::format("%.9g") % times[step]);
    text += csvLine(step, time, states[step]);
  }
  return text;
}

Eigen::MatrixXd parseTrajectoryCsv(const std::string& text, const std::vector<std::string>& names,
                                   const std::string& source) {
  Eigen::MatrixXd states(static_cast<Eigen::Index>(names.size()), 0);
  parseCsv(text, trajectoryHeader(names), source, [&](const std::vector<std::string>& cells) {
    requireStep(cells[0], static_cast<std::size_t>(states.cols()));
    csvNumber(cells[1]);
    states.conservativeResize(Eigen::NoChange, states.cols() + 1);
    states.rightCols(1) = numbersOf(cells, 2, names.size());
  });
  return states;
}

}  // namespace ddm
