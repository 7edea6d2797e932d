// Tests of PILCO's options: their rules, and the parameter reference config/pilco.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/options.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "../../test/manual.h"

namespace ddm::pilco {
namespace {

const char kManual[] = DDM_MPC_SOURCE_DIR "/config/pilco.yaml";

TEST(PilcoManual, GivesTheDefaultsOfEachBlockAndHoldsNothingElse) {
  expectManual<PilcoOptions>(kManual, "pilco");
  expectManual<GpTrainingOptions>(kManual, "gp");
  expectManual<SparseGpOptions>(kManual, "sparse_gp");
  expectManual<PolicySearchOptions>(kManual, "policy_search");
  EXPECT_EQ(keysOf(YAML::LoadFile(kManual)),
            (std::vector<std::string>{"pilco", "gp", "sparse_gp", "policy_search"}));
}

TEST(PilcoOptions, ReportAllProblemsAtOnce) {
  PilcoConfig config;
  config.pilco = {0, 0};
  config.gp = {-1, 1};
  config.sparse_gp = {0, -1, -1};
  config.policy_search = {-1, 0};
  EXPECT_EQ(config.pilco.problems().size(), 2U);
  EXPECT_EQ(config.gp.problems().size(), 2U);
  EXPECT_EQ(config.sparse_gp.problems().size(), 3U);
  EXPECT_EQ(config.policy_search.problems().size(), 2U);
}

}  // namespace
}  // namespace ddm::pilco
