// Tests of the blocks `mpc` and `controller`: rules, and the parameter reference config/mpc.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_options.h"

#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <string>
#include <vector>

#include "ddm_msgs/testing/parameter_reference.h"

namespace ddm {
namespace {

const char kReference[] = DDM_MPC_SOURCE_DIR "/config/mpc.yaml";

/// A block with one bad value is refused with the name of the key.
template <class Options>
void expectRefused(const std::string& block, const std::map<std::string, std::string>& bad_values) {
  EXPECT_TRUE(Options().problems().empty());
  for (const auto& [key, values] : bad_values) {
    for (const YAML::Node& value : YAML::Load(values)) {
      YAML::Node root;
      root[block][key] = value;
      ParamReader reader(root);
      const std::vector<std::string> problems = reader.template read<Options>(block).problems();
      ASSERT_EQ(problems.size(), 1U) << key << ": " << value;
      EXPECT_EQ(problems[0].rfind(block + "/" + key + " must ", 0), 0U) << problems[0];
      EXPECT_NE(problems[0].find(", got "), std::string::npos) << problems[0];
    }
  }
}

TEST(MpcOptions, RefuseValuesOutOfRangeNanIncluded) {
  expectRefused<MpcOptions>("mpc", {{"horizon", "[0, -1, 1001]"},
                                    {"cost", "[energy]"},
                                    {"control_weight", "[-0.1, .nan, .inf]"},
                                    {"offset_gain", "[-0.1, 1.01, .nan]"},
                                    {"max_torque", "[0.0, [1.0, .nan], [1.0, -0.1], .inf]"},
                                    {"epsilon", "[-0.1, 1.01, .nan]"},
                                    {"hold_steps", "[0, -1]"},
                                    {"num_starts", "[0, 1001]"},
                                    {"max_iterations", "[0, -1]"},
                                    {"function_tolerance", "[-0.1, 1.0, .nan]"},
                                    {"time_budget", "[-0.1, .nan, .inf]"}});
  expectRefused<ControllerOptions>("controller", {{"torque_dim", "[0, 1001]"},
                                                  {"timeout", "[0.0, -1.0, .nan, .inf]"},
                                                  {"dt", "[-0.1, 1000.1, .nan]"}});
}

TEST(ParameterReference, GivesTheDefaultsOfBothBlocksAndHoldsNothingElse) {
  testing::expectDefaults<MpcOptions>(kReference, "mpc");
  testing::expectDefaults<ControllerOptions>(kReference, "controller");
  EXPECT_EQ(YAML::LoadFile(kReference).size(), 2U);
}

}  // namespace
}  // namespace ddm
