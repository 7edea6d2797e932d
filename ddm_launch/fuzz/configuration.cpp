// Fuzz target: the configuration of an experiment, all its blocks.
// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <ddm_msgs/testing/fuzzing.h>

namespace {

ddm::Configuration read(const ddm::testing::MemoryFile& file) {
  ddm::ParamReader reader = ddm::ParamReader::fromFiles({file.path()});
  return ddm::readConfiguration(&reader);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A slash in plant/type would look for plugins in all of the workspace.
  if (std::find(data, data + size, '/') != data + size) return 0;
  static const ddm::testing::MemoryFile file;
  file.write(data, size);
  ddm::Configuration all;
  if (!ddm::testing::accepts<std::invalid_argument>([&] { all = read(file); })) return 0;
  const std::string written = YAML::Dump(ddm::toYaml(all));
  file.write(written.data(), written.size());
  ddm::testing::require(YAML::Dump(ddm::toYaml(read(file))) == written,
                        "a saved configuration comes back");
  return 0;
}
