// Tests of the options of plants from model files: what is refused by name, what completes them.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_mujoco/mujoco_plant.h"
#include "model_folder.h"

namespace ddm {
namespace {

using testing::arm;
using testing::armOptions;
using testing::armText;
using testing::armUrdf;
using testing::ModelFolder;
using testing::plantOf;
using testing::refusalOf;
using testing::urdfOptions;

struct Flaw {
  const char* name;
  std::function<std::unique_ptr<MujocoPlant>()> make;
  std::vector<std::string> words;  ///< that the refusal must have
};

void PrintTo(const Flaw& flaw, std::ostream* out) { *out << flaw.name; }

class MujocoPlantFlawTest : public ::testing::TestWithParam<Flaw> {};

TEST_P(MujocoPlantFlawTest, IsRefusedByName) {
  const std::string text = refusalOf(GetParam().make);
  for (const std::string& word : GetParam().words) {
    EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
  }
}

/// The arm with one option that is wrong.
std::function<std::unique_ptr<MujocoPlant>()> armWith(
    const std::function<void(MujocoOptions*)>& spoil) {
  return [spoil] {
    MujocoOptions options = armOptions();
    spoil(&options);
    return arm(options);
  };
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::vector<Flaw> options() {
  using O = MujocoOptions;
  return {
      {"UnknownMotor",
       armWith([](O* o) { o->motors = {"elbw"}; }),
       {"plant/motors", "elbw", "elbow?"}},
      {"TwoMotorsOfOneJoint",
       armWith([](O* o) {
         o->motors = {"elbow", "elbow"};
       }),
       {"plant/motors", "elbow"}},
      {"UnknownErrorJoint",
       armWith([](O* o) { o->error_joints = {"knee"}; }),
       {"plant/error_joints", "knee", "shoulder, elbow"}},
      {"UnknownGoalSite",
       armWith([](O* o) {
         o->goal_site = "top";
         o->goal_distance = {0.1, 0.2};
       }),
       {"plant/goal_site", "top", "tip"}},
      {"UnknownCamera", armWith([](O* o) { o->look.camera = "abowe"; }), {"abowe", "above"}},
      {"UnknownReward",
       armWith([](O* o) { o->reward = "reacher_esay"; }),
       {"plant/reward", "reacher_esay", "reacher_easy?"}},
      {"RewardOfAnotherPlant",
       armWith([](O* o) { o->reward = "pendulum_swingup"; }),
       {"plant/reward", "pendulum_swingup", "2 joints"}},
      {"TimeStepIsNoMultiple",
       armWith([](O* o) { o->dt = 0.125; }),
       {"plant/dt", "0.01", "0.125", "nearest"}},
      {"EpisodeIsNoMultiple",
       armWith([](O* o) { o->episode_frames = 1001; }),
       {"plant/episode_frames", "1001"}},
      {"LimitBeyondTheMotor",
       armWith([](O* o) {
         o->max_torque = {1.0, 0.5};
       }),
       {"plant/max_torque", "elbow", "0.4", "0.5"}},
      {"AnotherNumberOfLimits",
       armWith([](O* o) {
         o->max_torque = {0.1, 0.1, 0.1};
       }),
       {"plant/max_torque", "2", "3"}},
      {"AnotherNumberOfStarts",
       armWith([](O* o) {
         o->start = {0, 0, 0};
       }),
       {"plant/start", "3"}},
      {"AnotherNumberOfColumns",
       armWith([](O* o) {
         o->state_names = {"a", "b"};
       }),
       {"plant/state_names", "2"}},
      {"NoTolerance", armWith([](O* o) { o->tolerance = 0.0; }), {"plant/tolerance"}},
      {"NegativeTimestep", armWith([](O* o) { o->timestep = -0.01; }), {"plant/timestep", "-0.01"}},
      {"TinyTimestep",
       armWith([](O* o) { o->timestep = 1e-300; }),
       {"plant/timestep", "1000000", "1e-300"}},
  };
}

std::vector<Flaw> files() {
  const auto fileWith = [](const std::string& from, const std::string& to) {
    return [=] { return plantOf(replaced(armText(), from, to), armOptions()); };
  };
  const auto urdfWith = [](const std::function<void(MujocoOptions*)>& spoil) {
    return [spoil] {
      MujocoOptions options = urdfOptions();
      spoil(&options);
      return plantOf(armUrdf(), options, "arm.urdf");
    };
  };
  return {
      {"UrdfWithoutMotors",
       urdfWith([](MujocoOptions* o) { o->motors.clear(); }),
       {"plant/motors", "shoulder, elbow"}},
      {"JointWithoutALimit",
       urdfWith([](MujocoOptions* o) { o->max_torque.clear(); }),
       {"plant/max_torque", "shoulder", "effort"}},
      {"MotorWithoutALimit",
       fileWith("gear=\"2\" ctrllimited=\"true\" ctrlrange=\"-0.5 0.5\"", "gear=\"2\""),
       {"plant/max_torque", "shoulder", "ctrlrange"}},
      {"PositionServo",
       fileWith("<motor name=\"first\" joint=\"shoulder\" gear=\"2\"",
                "<position name=\"first\" joint=\"shoulder\""),
       {"actuator first", "motor", "plant/motors"}},
      {"OnewayControl",
       fileWith("ctrlrange=\"-0.5 0.5\"", "ctrlrange=\"0 0.5\""),
       {"actuator first", "ctrlrange [0, 0.5]", "symmetric", "plant/motors"}},
      {"LopsidedForce",
       fileWith("ctrlrange=\"-0.5 0.5\"",
                "ctrlrange=\"-0.5 0.5\" forcelimited=\"true\" forcerange=\"-3 1\""),
       {"actuator first", "forcerange [-3, 1]", "symmetric"}},
      {"FreeJoint",
       fileWith("<worldbody>",
                "<worldbody><body><freejoint name=\"loose\"/><geom size=\"0.1\"/></body>"),
       {"plant/model", "free joint", "loose"}},
      {"BallJoint", fileWith("axis=\"0 0 1\" damping=\"0.1\"/>", "type=\"ball\"/>"), {"shoulder"}},
      {"SlideBesideHinge",
       fileWith("axis=\"0 0 1\" damping=\"0.1\"/>", "type=\"slide\"/>"),
       {"plant/error_joints", "plant/error_sites"}},
  };
}

std::string flawName(const ::testing::TestParamInfo<Flaw>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Options, MujocoPlantFlawTest, ::testing::ValuesIn(options()), flawName);
INSTANTIATE_TEST_SUITE_P(Files, MujocoPlantFlawTest, ::testing::ValuesIn(files()), flawName);

TEST(MujocoOptions, AreCompletedByLimitsAndDigestAndRefuseThatOfAnotherFile) {
  const ModelFolder folder;
  const auto model = folder.loadText(armText());
  const MujocoOptions options = completed(armOptions(), *model);
  EXPECT_EQ(options.max_torque, (std::vector<double>{1.0, 0.4}));
  EXPECT_EQ(options.model_digest, model->digest());
  EXPECT_EQ(completed(options, *model).model_digest, model->digest());
  const auto changed = folder.loadText(armText("<!-- stronger -->"));
  const std::string text = refusalOf([&] { completed(options, *changed); });
  for (const std::string& word :
       {std::string("plant/model_digest"), model->digest(), changed->digest(), changed->uri()}) {
    EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
  }
}

TEST(MujocoOptions, AreRefusedForAFreeJointBeforeAnythingElseOfTheModel) {
  const ModelFolder folder;
  const auto model = folder.loadText(
      armText("<worldbody><body><freejoint name='loose'/><geom size='0.1'/></body></worldbody>"));
  EXPECT_TRUE(testing::names(refusalOf([&] { completed(armOptions(), *model); }),
                             {"plant/model", "free joint", "loose"}));
}

}  // namespace
}  // namespace ddm
