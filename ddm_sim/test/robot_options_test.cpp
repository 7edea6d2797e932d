// Tests of the parameters of a robot: what is refused, and that the manual tells the defaults.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/robot_options.h"

#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>

#include <limits>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

TEST(RobotOptions, TheManualTellsTheDefaults) {
  const std::string file = std::string(DDM_SIM_SOURCE_DIR) + "/config/robot.yaml";
  ParamReader reader = ParamReader::fromFiles({file});
  const auto manual = reader.read<RobotOptions>("robot");
  EXPECT_NO_THROW(reader.requireValid());
  EXPECT_EQ(YAML::Dump(toYaml(manual)), YAML::Dump(toYaml(RobotOptions())));
  const YAML::Node block = YAML::LoadFile(file)["robot"];
  EXPECT_EQ(block.size(), toYaml(RobotOptions()).size()) << "a key is missing in the manual";
}

TEST(RobotOptions, ANumberIsOneMotorAndAListHasOneEntryPerMotor) {
  const auto read = [](const std::string& text) {
    ParamReader reader(YAML::Load(text));
    const auto options = reader.read<RobotOptions>("robot");
    EXPECT_NO_THROW(reader.requireValid()) << text;
    return options;
  };
  const RobotOptions one = read("robot: {max_torque: 4}");
  EXPECT_EQ(one.numMotors(), 1);
  EXPECT_EQ(toYaml(one)["max_torque"].as<std::string>(), "4.0");
  const RobotOptions two = read("robot: {max_torque: [4, 2], slew_rate: 20}");
  EXPECT_EQ(two.numMotors(), 2);
  EXPECT_EQ(two.max_torque, (std::vector<double>{4.0, 2.0}));
  EXPECT_NO_THROW(read("robot: {max_torque: [4, 2], slew_rate: [20, 0]}"));
}

TEST(RobotOptions, EachKeyHasItsRule) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto problem = [](const auto& change) {
    RobotOptions options;
    change(&options);
    const std::vector<std::string> problems = options.problems();
    return problems.size() == 1 ? problems[0] : std::to_string(problems.size()) + " problems";
  };
  EXPECT_EQ(problem([](RobotOptions*) {}), "0 problems");
  EXPECT_TRUE(
      testing::names(problem([](auto* o) { o->dt = 0.0; }), {"robot/dt", "[0.001, 10]", "got 0"}));
  for (const double bad : {-1.0, nan}) {
    EXPECT_NE(problem([&](auto* o) { o->dt = bad; }).find("robot/dt"), std::string::npos);
    for (const std::vector<double>& torques : {std::vector<double>{bad}, {1.0, bad}}) {
      EXPECT_NE(problem([&](auto* o) { o->max_torque = torques; }).find("robot/max_torque"),
                std::string::npos);
    }
    EXPECT_NE(problem([&](auto* o) { o->slew_rate = {bad}; }).find("robot/slew_rate"),
              std::string::npos);
    EXPECT_NE(problem([&](auto* o) { o->effort_rate = bad; }).find("robot/effort_rate"),
              std::string::npos);
    EXPECT_NE(problem([&](auto* o) { o->reset_timeout = bad; }).find("robot/reset_timeout"),
              std::string::npos);
  }
  EXPECT_EQ(problem([](auto* o) { o->max_torque = {0.0}; }).find("robot/max_torque"), 0u);
  EXPECT_EQ(problem([](auto* o) { o->max_torque = {}; }).find("robot/max_torque"), 0u);
  EXPECT_EQ(problem([](auto* o) { o->slew_rate = {}; }).find("robot/slew_rate"), 0u);
  EXPECT_EQ(problem([](auto* o) { o->slew_rate = {1.0, 2.0}; }).find("robot/slew_rate"), 0u);
  for (const std::vector<double>& bad : std::vector<std::vector<double>>{
           {}, {1.0}, {1.0, 1.0}, {2.0, 1.0}, {nan, 1.0}, {0.0, nan}, {0.0, 1.0, 2.0}}) {
    EXPECT_NE(problem([&](auto* o) { o->position_limits = {bad}; }).find("robot/position_limits"),
              std::string::npos);
  }
  for (const double bad : {0.0, -1.0, nan}) {
    EXPECT_NE(problem([&](auto* o) { o->speed_limit = {bad}; }).find("robot/speed_limit"),
              std::string::npos);
  }
  EXPECT_NE(problem([](auto* o) { o->effort_rate = 19.0; }).find("robot/effort_rate"),
            std::string::npos);
  EXPECT_NE(problem([](auto* o) { o->joints = {"arm"}; }).find("robot/joints"), std::string::npos);
  EXPECT_NE(problem([](auto* o) { o->max_hold = 0.0; }).find("robot/max_hold"), std::string::npos);
  for (const std::vector<std::string>& names : {std::vector<std::string>{}, {"arm", "arm"}}) {
    EXPECT_EQ(problem([&](auto* o) {
                o->joints = names;
                o->position_limits = {{0.0, 1.0}, {0.0, 1.0}};
              }).find("robot/joints"),
              0u)
        << "names decide where several joints have limits";
  }
  EXPECT_TRUE(testing::names(problem([](auto* o) {
                               o->joints = {"elbow", "wrist"};
                               o->speed_limit = {1.0};
                             }),
                             {"robot/speed_limit", "robot/joints, 2", "got 1"}));
  EXPECT_EQ(problem([](auto* o) {
              o->joints = {"arm"};
              o->position_limits = {{-2.0, std::numeric_limits<double>::infinity()}};
              o->speed_limit = {8.0};
            }),
            "0 problems");
  EXPECT_NE(problem([](auto* o) { o->crop_x = -1; }).find("robot/crop_x"), std::string::npos);
  EXPECT_NE(problem([](auto* o) { o->crop_y = 16384; }).find("robot/crop_y"), std::string::npos);
  EXPECT_NE(problem([](auto* o) { o->crop_width = -1; }).find("robot/crop_width"),
            std::string::npos);
  EXPECT_NE(problem([](auto* o) { o->crop_height = 20000; }).find("robot/crop_height"),
            std::string::npos);
}

}  // namespace
}  // namespace ddm
