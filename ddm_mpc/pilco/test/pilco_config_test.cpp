// Tests of the manual of the blocks `gp`, `sparse_gp` and `policy_search`, config/pilco.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "../../test/manual.h"
#include "ddm_pilco/gp_training.h"
#include "ddm_pilco/policy_search.h"
#include "ddm_pilco/sparse_gp.h"

namespace ddm {
namespace pilco {
namespace {

const char kManual[] = DDM_MPC_SOURCE_DIR "/config/pilco.yaml";

TEST(PilcoManual, GivesTheDefaultsOfEachBlock) {
  expectManual<GpTrainingOptions>(kManual, "gp");
  expectManual<SparseGpOptions>(kManual, "sparse_gp");
  expectManual<PolicySearchOptions>(kManual, "policy_search");
}

TEST(PilcoManual, HoldsNothingElse) {
  EXPECT_EQ(keysOf(YAML::LoadFile(kManual)),
            (std::vector<std::string>{"gp", "sparse_gp", "policy_search"}));
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
