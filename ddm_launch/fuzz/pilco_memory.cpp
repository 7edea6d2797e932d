// Fuzz target: pilco.yaml of a trial, from which the next training goes on.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>

#include "pilco/pilco_method.h"

using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  ddm::PilcoMemory memory;
  const auto read = [&] { memory = ddm::readMemory(text, "pilco.yaml"); };
  if (!ddm::testing::accepts<std::runtime_error>(read)) return 0;
  require(memory.policy.allFinite() && memory.gps.inducing.allFinite(), "numbers are finite");
  YAML::Node written(YAML::NodeType::Map);
  ddm::writeMemory(memory, &written);
  const ddm::PilcoMemory again = ddm::readMemory(YAML::Dump(written), "pilco.yaml");
  require(again.policy == memory.policy, "a policy comes back digit by digit");
  return 0;
}
