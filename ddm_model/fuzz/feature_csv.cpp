// Fuzz target: features on the standard input of decode_features.
// SPDX-License-Identifier: BSD-3-Clause
#include "feature_csv.h"

#include <ddm_msgs/testing/fuzzing.h>

#include <sstream>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kFeatureDim = 2;
  std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
  std::vector<Eigen::VectorXd> features;
  const auto read = [&] { features = ddm::readFeatures(text, kFeatureDim); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return 0;
  ddm::testing::require(!features.empty(), "there is a feature");
  for (const Eigen::VectorXd& z : features) {
    ddm::testing::require(z.size() == kFeatureDim && z.allFinite(), "features are finite");
  }
  return 0;
}
