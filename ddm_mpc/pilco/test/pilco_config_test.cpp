// Tests of the manual of the blocks `gp`, `sparse_gp` and `policy_search`, config/pilco.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/param_reader.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "ddm_pilco/gp_training.h"
#include "ddm_pilco/policy_search.h"
#include "ddm_pilco/sparse_gp.h"

namespace ddm {
namespace pilco {
namespace {

const char kManual[] = DDM_MPC_SOURCE_DIR "/config/pilco.yaml";

std::vector<std::string> keysOf(const YAML::Node& block) {
  std::vector<std::string> keys;
  for (const auto& entry : block) keys.push_back(entry.first.as<std::string>());
  return keys;
}

/// Each key of the block stands in the manual with its default, in the order of the struct.
template <class Options>
void expectManual(const std::string& block) {
  ParamReader reader = ParamReader::fromFiles({kManual});
  const YAML::Node defaults = toYaml(Options());
  EXPECT_EQ(YAML::Dump(toYaml(reader.read<Options>(block))), YAML::Dump(defaults));
  EXPECT_EQ(keysOf(YAML::LoadFile(kManual)[block]), keysOf(defaults));
  EXPECT_NO_THROW(reader.requireValid());
}

TEST(PilcoManual, GivesTheDefaultsOfEachBlock) {
  expectManual<GpTrainingOptions>("gp");
  expectManual<SparseGpOptions>("sparse_gp");
  expectManual<PolicySearchOptions>("policy_search");
}

TEST(PilcoManual, HoldsNothingElse) {
  EXPECT_EQ(keysOf(YAML::LoadFile(kManual)),
            (std::vector<std::string>{"gp", "sparse_gp", "policy_search"}));
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
