// Fuzz target: torques.csv and trajectory.csv of a run.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_csv.h"

#include <ddm_msgs/testing/fuzzing.h>

using ddm::testing::accepts;
using ddm::testing::require;

namespace {

void checkTorques(const std::string& text) {
  static const std::vector<std::string> names = {"dx_px", "dy_px"};
  ddm::TorqueRows rows;
  const auto read = [&] { rows = ddm::parseTorquesCsv(text, names, "torques.csv"); };
  if (!accepts<std::runtime_error>(read)) return;
  require(rows.torques.size() == rows.exploratory.size(), "each torque is exploratory or not");
  for (const Eigen::VectorXd& torque : rows.torques) {
    require(torque.size() == 2 && torque.allFinite(), "torques are finite");
  }
  const ddm::TorqueRows again =
      ddm::parseTorquesCsv(ddm::formatTorquesCsv(rows, names), names, "torques.csv");
  require(again.torques == rows.torques && again.exploratory == rows.exploratory,
          "torques come back digit by digit");
}

void checkTrajectory(const std::string& text) {
  static const std::vector<std::string> names = {"x_px", "y_px"};
  Eigen::MatrixXd states;
  const auto read = [&] { states = ddm::parseTrajectoryCsv(text, names, "trajectory.csv"); };
  if (!accepts<std::runtime_error>(read)) return;
  require(states.rows() == 2 && states.allFinite(), "states are finite");
  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index i = 0; i < states.cols(); ++i) columns.push_back(states.col(i));
  const std::string written =
      ddm::formatTrajectoryCsv(std::vector<double>(columns.size(), 0.2), columns, names);
  require(ddm::parseTrajectoryCsv(written, names, "trajectory.csv") == states,
          "states come back digit by digit");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  checkTorques(text);
  checkTrajectory(text);
  return 0;
}
