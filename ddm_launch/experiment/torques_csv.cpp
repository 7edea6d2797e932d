// torques.csv: the torque of each step of a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "torques_csv.h"

#include <stdexcept>

#include "csv_text.h"

namespace ddm {
namespace {

std::string headerOf(const std::vector<std::string>& names) {
  return csvHeader("step", names) + ",exploratory";
}

void takeRow(const std::vector<std::string>& cells, TorqueRows* rows) {
  const std::string step = std::to_string(rows->torques.size());
  if (cells[0] != step) throw std::runtime_error("must be step " + step + ", got " + cells[0]);
  Eigen::VectorXd torque(static_cast<Eigen::Index>(cells.size()) - 2);
  for (size_t i = 1; i + 1 < cells.size(); ++i) {
    torque[static_cast<Eigen::Index>(i) - 1] = csvNumber(cells[i]);
  }
  if (cells.back() != "0" && cells.back() != "1") {
    throw std::runtime_error("'" + cells.back() + "' must be 0 or 1");
  }
  rows->torques.push_back(torque);
  rows->exploratory.push_back(cells.back() == "1");
}

}  // namespace

std::string formatTorquesCsv(const TorqueRows& rows, const std::vector<std::string>& names) {
  std::string text = headerOf(names) + "\n";
  for (size_t step = 0; step < rows.torques.size(); ++step) {
    text += std::to_string(step) + csvValues(rows.torques[step]) +
            (rows.exploratory[step] ? ",1\n" : ",0\n");
  }
  return text;
}

TorqueRows parseTorquesCsv(const std::string& text, const std::vector<std::string>& names,
                           const std::string& source) {
  TorqueRows rows;
  parseCsv(text, headerOf(names), source,
           [&rows](const std::vector<std::string>& cells) { takeRow(cells, &rows); });
  return rows;
}

}  // namespace ddm
