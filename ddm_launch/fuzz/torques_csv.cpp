// Fuzz target: torques.csv of a run folder.
// SPDX-License-Identifier: BSD-3-Clause
#include "torques_csv.h"

#include <ddm_msgs/testing/fuzzing.h>

using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<std::string> names = {"dx_px", "dy_px"};
  const std::string text(reinterpret_cast<const char*>(data), size);
  ddm::TorqueRows rows;
  const auto read = [&] { rows = ddm::parseTorquesCsv(text, names, "torques.csv"); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return 0;
  require(rows.torques.size() == rows.exploratory.size(), "each torque is exploratory or not");
  for (const Eigen::VectorXd& torque : rows.torques) {
    require(torque.size() == 2 && torque.allFinite(), "torques are finite");
  }
  const ddm::TorqueRows again =
      ddm::parseTorquesCsv(ddm::formatTorquesCsv(rows, names), names, "torques.csv");
  require(again.torques == rows.torques && again.exploratory == rows.exploratory,
          "torques come back digit by digit");
  return 0;
}
