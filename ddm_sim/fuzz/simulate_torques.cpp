// Fuzz target: numbers on the standard input of simulate.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>

#include <sstream>

#include "number_csv.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
  std::vector<Eigen::VectorXd> torques;
  const auto read = [&] { torques = ddm::readNumbers(text, {"dx_px", "dy_px"}, "a torque"); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return 0;
  for (const Eigen::VectorXd& torque : torques) {
    ddm::testing::require(torque.size() == 2 && torque.allFinite(), "torques are finite");
  }
  return 0;
}
