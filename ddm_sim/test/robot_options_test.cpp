// Tests of the parameters of a robot: refused values, and the defaults in the parameter reference.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/robot_options.h"

#include <gtest/gtest.h>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/parameter_reference.h"

namespace ddm {
namespace {

TEST(RobotOptions, TheParameterReferenceHasTheDefaults) {
  testing::expectDefaults<RobotOptions>(DDM_SIM_SOURCE_DIR "/config/robot.yaml", "robot");
}

/// Returns the problems of the block `robot` with these keys.
std::vector<std::string> problemsOf(const std::string& keys, RobotOptions* options = nullptr) {
  ParamReader reader(YAML::Load("robot: {" + keys + "}"));
  const auto read = reader.read<RobotOptions>("robot");
  if (options != nullptr) *options = read;
  return reader.problems();
}

TEST(RobotOptions, ANumberIsOneMotorAndAListHasOneEntryPerMotor) {
  RobotOptions options;
  EXPECT_TRUE(problemsOf("max_torque: 4", &options).empty());
  EXPECT_EQ(options.numMotors(), 1);
  EXPECT_TRUE(problemsOf("max_torque: [4, 2], slew_rate: 20", &options).empty());
  EXPECT_EQ(options.max_torque, (std::vector<double>{4.0, 2.0}));
  EXPECT_TRUE(problemsOf("max_torque: [4, 2], slew_rate: [20, 0]").empty());
}

TEST(RobotOptions, EachKeyHasItsRule) {
  for (const std::string good :
       {"", "joints: [arm], position_limits: [[-2, .inf]], speed_limit: [8]"}) {
    EXPECT_EQ(problemsOf(good), std::vector<std::string>()) << good;
  }
  struct Case {
    const char* key;
    std::vector<std::string> values;
  };
  const std::vector<Case> cases = {
      {"dt", {"0.0", "-1.0", ".nan", "11"}},
      {"max_torque", {"0.0", "-1.0", ".nan", "[1.0, .nan]", "[]"}},
      {"slew_rate", {"-1.0", ".nan", "[]", "[1.0, 2.0]"}},
      {"max_hold", {"0.0", ".nan", "21"}},
      {"reset_timeout", {"0.0", "-1.0", ".nan"}},
      {"crop", {"[-1, 0, 0, 0]", "[0, 16385, 0, 0]", "[0, 0, -1, 0]", "[1, 2, 3]", "[]"}},
      {"position_limits",
       {"[[]]", "[[1]]", "[[1, 1]]", "[[2, 1]]", "[[.nan, 1]]", "[[0, .nan]]", "[[0, 1, 2]]"}},
      {"speed_limit", {"0.0", "-1.0", ".nan"}},
      // Names are required if several joints have limits.
      {"joints",
       {"[arm]", "[], position_limits: [[0, 1], [0, 1]]",
        "[arm, arm], position_limits: [[0, 1], [0, 1]]"}}};
  for (const Case& each : cases) {
    for (const std::string& value : each.values) {
      const std::vector<std::string> problems = problemsOf(each.key + (": " + value));
      ASSERT_EQ(problems.size(), 1U) << each.key << ": " << value;
      EXPECT_EQ(problems[0].rfind("robot/" + std::string(each.key) + " must ", 0), 0U)
          << problems[0];
    }
  }
  EXPECT_TRUE(testing::names(problemsOf("joints: [elbow, wrist], speed_limit: [1]").at(0),
                             {"robot/speed_limit", "robot/joints, 2", "got 1"}));
}

}  // namespace
}  // namespace ddm
