// What must hold for the manual of a parameter block, a file of config/.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {

inline std::vector<std::string> keysOf(const YAML::Node& block) {
  std::vector<std::string> keys;
  for (const auto& entry : block) keys.push_back(entry.first.as<std::string>());
  return keys;
}

/// Each key of the block stands in the manual with its default, in the order of the struct.
template <class Options>
void expectManual(const std::string& manual, const std::string& block) {
  ParamReader reader = ParamReader::fromFiles({manual});
  const YAML::Node defaults = toYaml(Options());
  EXPECT_EQ(YAML::Dump(toYaml(reader.read<Options>(block))), YAML::Dump(defaults));
  EXPECT_EQ(keysOf(YAML::LoadFile(manual)[block]), keysOf(defaults));
  EXPECT_NO_THROW(reader.requireValid());
}

}  // namespace ddm
