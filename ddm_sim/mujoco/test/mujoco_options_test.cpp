// Tests options of plants with model files: invalid values, and values from the model file.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/mujoco_options.h"

#include <ddm_common/param_reader.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <tuple>
#include <utility>
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
using testing::replaced;
using testing::urdfOptions;

using Words = std::vector<std::string>;

/// Changes options by keys in YAML, as a plant file does.
MujocoOptions with(const MujocoOptions& options, const std::string& yaml) {
  YAML::Node blocks;
  blocks["plant"] = toYaml(options);
  for (const auto& one : YAML::Load("{" + yaml + "}")) {
    blocks["plant"][one.first.as<std::string>()] = one.second;
  }
  return ParamReader(blocks).read<MujocoOptions>("plant");
}

TEST(MujocoOptions, AreRefusedByNameWhereTheyDoNotFitTheModel) {
  const std::pair<const char*, Words> flaws[] = {
      {"motors: [elbw]", {"plant/motors", "elbw", "elbow?"}},
      {"motors: [elbow, elbow]", {"plant/motors", "elbow"}},
      {"goal_site: top, goal_distance: [0.1, 0.2]", {"plant/goal_site", "top", "tip"}},
      {"camera: abowe", {"abowe", "above"}},
      {"reward: reacher_esay", {"plant/reward", "reacher_esay", "reacher_easy?"}},
      {"dt: 0.125", {"plant/dt", "0.01", "0.125", "nearest"}},
      {"episode_frames: 1001", {"plant/episode_frames", "1001"}},
      {"max_torque: [1.0, 0.5]", {"plant/max_torque", "elbow", "0.4", "0.5"}},
      {"start: [0.0, 0.0, 0.0]", {"plant/start", "3"}},
      {"tolerance: 0.0", {"plant/tolerance"}},
      {"timestep: 1.0e-300", {"plant/timestep", "1000000", "1e-300"}}};
  for (const auto& [yaml, words] : flaws) {
    EXPECT_TRUE(testing::names(refusalOf([&, y = yaml] { arm(with(armOptions(), y)); }), words));
  }
  EXPECT_TRUE(testing::names(
      refusalOf([] { plantOf(armUrdf(), with(urdfOptions(), "motors: []"), "arm.urdf"); }),
      {"plant/motors", "shoulder, elbow"}));
  EXPECT_TRUE(testing::names(
      refusalOf([] { plantOf(armUrdf(), with(urdfOptions(), "max_torque: []"), "arm.urdf"); }),
      {"plant/max_torque", "shoulder", "effort"}));
}

TEST(MujocoOptions, AreRefusedForAModelWhoseJointsMotorsOrTimestepCannotBeUsed) {
  const std::string control = "ctrlrange=\"-0.5 0.5\"", limit = "ctrllimited=\"true\" " + control,
                    joint = "axis=\"0 0 1\" damping=\"0.1\"/>", timestep = "timestep=\"0.01\"";
  const std::tuple<std::string, std::string, Words> flaws[] = {
      {"gear=\"2\" " + limit, "gear=\"2\"", {"plant/max_torque", "shoulder", "ctrlrange"}},
      {"<motor name=\"first\" joint=\"shoulder\" gear=\"2\"",
       "<position name=\"first\" joint=\"shoulder\"",
       {"actuator first", "motor", "plant/motors"}},
      {control, "ctrlrange=\"0 0.5\"", {"actuator first", "[0, 1]", "symmetric", "plant/motors"}},
      {"<worldbody>",
       "<worldbody><body><freejoint name=\"loose\"/><geom size=\"0.1\"/></body>",
       {"plant/model", "free joint", "loose"}},
      {joint, "type=\"ball\"/>", {"shoulder"}},
      {joint, "axis=\"0 0 1\" damping=\"-3\"/>", {"shoulder", "model.xml", "damping >= 0", "-3"}},
      {timestep, "timestep=\"0\"", {"timestep of", "model.xml", "at least 2e-05 s, got 0"}},
      {timestep, "timestep=\"1e-06\"", {"at least 2e-05", "1e-06", "plant/timestep"}},
      {timestep, "timestep=\"-0.01\"", {"at least 2e-05", "-0.01", "plant/timestep"}}};
  for (const auto& flaw : flaws) {
    const std::string text = replaced(armText(), std::get<0>(flaw), std::get<1>(flaw));
    EXPECT_TRUE(testing::names(refusalOf([&] { plantOf(text, armOptions()); }), std::get<2>(flaw)));
  }
}

TEST(MujocoOptions, QuoteATorqueRangeThatIsNoLimitInBothDirections) {
  const std::string text = replaced(armText(), "ctrlrange=\"-0.5 0.5\"", "ctrlrange=\"0 0.5\"");
  const MujocoOptions options = with(armOptions(), "motors: [shoulder], max_torque: []");
  EXPECT_TRUE(testing::names(refusalOf([&] { plantOf(text, options); }),
                             {"plant/max_torque", "[0, 1]", "shoulder", "symmetric"}));
}

TEST(MujocoOptions, MayGiveALimitOfTheFileInSevenDigits) {
  EXPECT_EQ(refusalOf([] { arm(with(armOptions(), "max_torque: [1.0000004, 0.4]")); }), "");
}

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

TEST(MujocoOptions, ReportAllProblemsOfTheImage) {
  const MujocoOptions options = with(armOptions(), "camera_position: [0.0, 1.0], supersampling: 9");
  EXPECT_TRUE(
      testing::names(refusalOf([&] { arm(options); }),
                     {"plant/camera_position", "plant/camera_look_at", "plant/supersampling"}));
}

TEST(MujocoOptions, AreInTheParameterReferenceWithTheirDefaultsButForWhatThePendulumNeeds) {
  const std::string file = DDM_SIM_SOURCE_DIR "/config/mujoco_pendulum.yaml";
  const YAML::Node reference = YAML::LoadFile(file)["plant"];
  const std::set<std::string> of_the_pendulum = {
      "model",         "max_torque",  "start",        "goal",   "tolerance",
      "visible_sites", "state_names", "torque_names", "camera", "supersampling"};
  ParamReader reader = ParamReader::fromFiles({file});
  const YAML::Node read = toYaml(reader.read<MujocoOptions>("plant"));
  ASSERT_NO_THROW(reader.requireValid());
  const YAML::Node defaults = toYaml(MujocoOptions());
  EXPECT_EQ(reference.size(), defaults.size());
  for (const auto& entry : defaults) {
    const auto key = entry.first.as<std::string>();
    EXPECT_TRUE(reference[key].IsDefined()) << key;
    EXPECT_EQ(YAML::Dump(read[key]) == YAML::Dump(entry.second), of_the_pendulum.count(key) == 0)
        << key << " of the reference is " << YAML::Dump(read[key]);
  }
}

}  // namespace
}  // namespace ddm
