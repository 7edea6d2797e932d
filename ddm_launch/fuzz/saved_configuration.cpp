// Fuzz target: config.yaml of a folder that shall be used again.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>
#include <ddm_params/config_blocks.h>

#include "results_folder.h"

using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  YAML::Node saved;
  const auto read = [&] { saved = ddm::parseBlocks(text, "config.yaml"); };
  if (!ddm::testing::accepts<std::invalid_argument>(read)) return 0;
  require(ddm::differencesOf(saved, saved, true).empty(), "nothing differs from itself");
  YAML::Node other = YAML::Clone(saved);
  other["mpc"] = YAML::Load("{horizon: a value that no file has}");
  require(!ddm::differencesOf(saved, other, true).empty(), "another value is a difference");
  return 0;
}
