// Fuzz target of ddm_launch: configurations.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/fuzzing.h>

#include <algorithm>

#include "configuration.h"

using ddm::testing::accepts;
using ddm::testing::require;

namespace {

ddm::Configuration read(const ddm::testing::MemoryFile& file) {
  ddm::ParamReader reader = ddm::ParamReader::fromFiles({file.path()});
  return ddm::readConfiguration(&reader);
}

/// Fuzzes all blocks of the configuration of an experiment.
void configuration(const std::uint8_t* data, std::size_t size) {
  // A slash in plant/type would make the program search the whole workspace for plugins.
  if (std::find(data, data + size, '/') != data + size) return;
  static const ddm::testing::MemoryFile file;
  file.write(data, size);
  ddm::Configuration all;
  if (!accepts<std::invalid_argument>([&] { all = read(file); })) return;
  const std::string written = YAML::Dump(ddm::toYaml(all));
  file.write(written.data(), written.size());
  require(YAML::Dump(ddm::toYaml(read(file))) == written, "a saved configuration comes back");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::FuzzTarget target =
      ddm::testing::chosenTarget({{"configuration", configuration}});
  target(data, size);
  return 0;
}
