// Tests of the blocks `mpc` and `controller`: rules, and the manual in config/mpc.yaml.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_options.h"

#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "ddm_msgs/testing/not_finite.h"
#include "manual.h"

namespace ddm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const char kManual[] = DDM_MPC_SOURCE_DIR "/config/mpc.yaml";

/// The one problem of the options after `spoil` names the key.
template <class Options>
void expectProblem(const std::string& key, const std::function<void(Options*)>& spoil) {
  Options options;
  spoil(&options);
  const std::vector<std::string> problems = options.problems();
  ASSERT_EQ(problems.size(), 1U) << key;
  EXPECT_EQ(problems[0].rfind(key + " must ", 0), 0U) << problems[0];
  EXPECT_NE(problems[0].find(", got "), std::string::npos) << problems[0];
}

TEST(MpcOptions, AreValidByDefaultAndReportAllProblemsAtOnce) {
  EXPECT_EQ(MpcOptions().problems().size(), 0U);
  EXPECT_EQ(ControllerOptions().problems().size(), 0U);
  MpcOptions options;
  options.horizon = 0;
  options.cost = "energy";
  EXPECT_EQ(options.problems().size(), 2U);
}

TEST(MpcOptions, RefuseIntegersOutOfRange) {
  for (const int bad : {0, -1, 1001}) {
    expectProblem<MpcOptions>("mpc/horizon", [bad](MpcOptions* o) { o->horizon = bad; });
    expectProblem<MpcOptions>("mpc/num_starts", [bad](MpcOptions* o) { o->num_starts = bad; });
  }
  for (const int bad : {0, -1}) {
    expectProblem<MpcOptions>("mpc/hold_steps", [bad](MpcOptions* o) { o->hold_steps = bad; });
    expectProblem<MpcOptions>("mpc/max_iterations",
                              [bad](MpcOptions* o) { o->max_iterations = bad; });
  }
}

TEST(MpcOptions, RefuseNumbersOutOfRangeNanIncluded) {
  for (const double bad : {-0.1, kNan, kInfinity}) {
    expectProblem<MpcOptions>("mpc/control_weight",
                              [bad](MpcOptions* o) { o->control_weight = bad; });
    expectProblem<MpcOptions>("mpc/max_torque", [bad](MpcOptions* o) {
      o->max_torque = {1.0, bad};
    });
    expectProblem<MpcOptions>("mpc/epsilon", [bad](MpcOptions* o) { o->epsilon = bad; });
    expectProblem<MpcOptions>("mpc/function_tolerance",
                              [bad](MpcOptions* o) { o->function_tolerance = bad; });
    expectProblem<MpcOptions>("mpc/time_budget", [bad](MpcOptions* o) { o->time_budget = bad; });
    expectProblem<MpcOptions>("mpc/offset_gain", [bad](MpcOptions* o) { o->offset_gain = bad; });
  }
  expectProblem<MpcOptions>("mpc/offset_gain", [](MpcOptions* o) { o->offset_gain = 1.01; });
  expectProblem<MpcOptions>("mpc/max_torque", [](MpcOptions* o) { o->max_torque = {0.0}; });
  expectProblem<MpcOptions>("mpc/epsilon", [](MpcOptions* o) { o->epsilon = 1.01; });
  expectProblem<MpcOptions>("mpc/function_tolerance",
                            [](MpcOptions* o) { o->function_tolerance = 1.0; });
}

TEST(ControllerOptions, RefuseValuesOutOfRangeNanIncluded) {
  for (const int bad : {0, 1001}) {
    expectProblem<ControllerOptions>("controller/torque_dim",
                                     [bad](ControllerOptions* o) { o->torque_dim = bad; });
  }
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    expectProblem<ControllerOptions>("controller/timeout",
                                     [bad](ControllerOptions* o) { o->timeout = bad; });
  }
}

TEST(Manual, GivesTheDefaultsOfBothBlocksAndHoldsNothingElse) {
  expectManual<MpcOptions>(kManual, "mpc");
  expectManual<ControllerOptions>(kManual, "controller");
  EXPECT_EQ(YAML::LoadFile(kManual).size(), 2U);
}

}  // namespace
}  // namespace ddm
