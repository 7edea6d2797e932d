// Fuzz target: trajectory.csv of a run folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_csv.h"

#include <ddm_msgs/testing/fuzzing.h>

using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::string> names = {"x_px", "y_px"};
  const std::string text(reinterpret_cast<const char*>(data), size);
  Eigen::MatrixXd states;
  const auto read = [&] { states = ddm::parseTrajectoryCsv(text, names, "trajectory.csv"); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return 0;
  require(states.rows() == 2 && states.allFinite(), "states are finite");

  std::vector<Eigen::VectorXd> columns;
  for (Eigen::Index i = 0; i < states.cols(); ++i) columns.push_back(states.col(i));
  const std::string written =
      ddm::formatTrajectoryCsv(std::vector<double>(columns.size(), 0.2), columns, names);
  require(ddm::parseTrajectoryCsv(written, names, "trajectory.csv") == states,
          "states come back digit by digit");
  return 0;
}
