// Checks a parameter reference: a YAML file in config/ that lists and explains the keys of a block.
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

/// Expects that the block of the file contains exactly the keys of the struct, in the order of
/// visit(), with their default values.
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
