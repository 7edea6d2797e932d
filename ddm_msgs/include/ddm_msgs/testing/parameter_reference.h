// What must hold for a parameter reference, a YAML file of config/ that explains blocks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {
namespace testing {

inline std::vector<std::string> keysOf(const YAML::Node& map) {
  std::vector<std::string> keys;
  for (const auto& entry : map) keys.push_back(entry.first.as<std::string>());
  return keys;
}

/// Each key of the struct stands in the block with its default, in the order of visit(), and no other
/// key does.
template <class Options>
void expectDefaults(const std::string& file, const std::string& block) {
  ParamReader reader = ParamReader::fromFiles({file});
  const YAML::Node defaults = toYaml(Options());
  EXPECT_EQ(YAML::Dump(toYaml(reader.read<Options>(block))), YAML::Dump(defaults)) << block;
  EXPECT_EQ(keysOf(YAML::LoadFile(file)[block]), keysOf(defaults)) << block;
  EXPECT_NO_THROW(reader.requireValid());
}

}  // namespace testing
}  // namespace ddm
