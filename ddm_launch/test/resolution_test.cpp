// Tests of resolve(): which layer overrides which, and how a saved configuration is used.
// SPDX-License-Identifier: BSD-3-Clause
#include "resolution.h"

#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include "configuration.h"
#include "toy_run.h"

namespace ddm {
namespace {

using testing::TempFolder;
using testing::throwsNaming;
using testing::writeText;

class Resolution : public ::testing::Test {
 protected:
  /// Writes a file and returns its path.
  std::string file(const std::string& name, const std::string& text) const {
    writeText(folder_.file(name), text);
    return folder_.file(name);
  }

  Configuration read() const {
    ParamReader reader = resolve(given_).reader();
    return readConfiguration(&reader);
  }

  static double gravity(const Configuration& all) {
    return all.plant->block()["gravity"].as<double>();
  }

  /// Writes the current configuration as experiments save it, and returns the path.
  std::string saved() const {
    return file("config.yaml", "version: 0.1.0 (test)\n" + YAML::Dump(toYaml(read())) + "\n");
  }

  Arguments given_;
  TempFolder folder_;
};

TEST_F(Resolution, WithoutArgumentsGivesTheDefaults) {
  const Configuration all = read();
  EXPECT_EQ(YAML::Dump(toYaml(all.experiment)), YAML::Dump(toYaml(ExperimentOptions())));
  EXPECT_EQ(all.trial.num_steps, 100);
}

TEST_F(Resolution, LaterLayersWinKeyByKey) {
  // pilco_state sets trial/num_steps to 125 and mpc/epsilon to 0; noise sets camera/noise_std to
  // 0.1.
  given_.set("experiment/method", std::string("pilco_state"));
  given_.set("experiment/plant", std::string("pendulum_gravity"));
  EXPECT_EQ(read().trial.num_steps, 125);
  EXPECT_EQ(gravity(read()), 9.82);
  given_.configs = {"nuisance/noise"};
  EXPECT_EQ(read().camera.noise_std, 0.1);
  given_.configs = {"nuisance/noise",
                    file("a.yaml", "camera: {noise_std: 0.2, delay: 2}\nexperiment: {seed: 3}\n"),
                    file("b.yaml", "camera: {noise_std: 0.3}\n")};
  EXPECT_EQ(read().camera.noise_std, 0.3);
  EXPECT_EQ(read().camera.delay, 2);
  EXPECT_EQ(read().experiment.seed, 3);
  given_.set("experiment/seed", 4);
  EXPECT_EQ(read().experiment.seed, 4);
}

TEST_F(Resolution, AFileNamesPresetPlantAndMethodWhereNoArgumentDoes) {
  given_.configs = {
      file("names.yaml", "experiment: {preset: debug, plant: moving_tile, method: pilco_pca}\n")};
  Configuration all = read();
  EXPECT_EQ(all.plant->type(), "moving_tile");
  EXPECT_EQ(all.model.model.encoder_widths, std::vector<int>{6});  // from preset debug
  EXPECT_EQ(all.trial.num_steps, 125);                             // from the method
  given_.set("experiment/plant", std::string("pendulum"));
  all = read();
  EXPECT_EQ(all.plant->type(), "pendulum");
  EXPECT_EQ(all.experiment.preset, "debug");
}

TEST_F(Resolution, ASavedConfigurationComesBackWhole) {
  given_.set("experiment/preset", std::string("debug"));
  given_.set("experiment/plant", std::string("pendulum_gravity"));
  given_.set("experiment/seed", 5);
  given_.set("experiment/trials", 2);
  given_.set("start/model", std::string("/model.ddm"));
  given_.set("start/bags", std::vector<std::string>{"/a.bag", "/b c.bag"});
  given_.configs = {"nuisance/noise", "nuisance/delay"};
  const std::string before = YAML::Dump(toYaml(read()));
  const std::string config = saved();
  given_ = Arguments();
  given_.configs = {config};
  EXPECT_EQ(YAML::Dump(toYaml(read())), before);
  given_.set("experiment/trials", 3);
  EXPECT_EQ(read().experiment.seed, 5);
  EXPECT_EQ(read().experiment.trials, 3);
}

TEST_F(Resolution, PlansTakeHalfATimeStepInRealTimeUnlessAnythingSaysOtherwise) {
  EXPECT_EQ(read().mpc.time_budget, 0.0);
  given_.set("sim/lockstep", false);
  EXPECT_EQ(read().mpc.time_budget, 0.1);
  given_.configs = {file("robot.yaml", "robot: {dt: 0.05}\n")};
  EXPECT_EQ(read().mpc.time_budget, 0.025);
  given_.configs = {file("limits.yaml", "robot: {max_torque: 1.0}\n")};
  EXPECT_EQ(read().mpc.time_budget, 0.5 * RobotOptions().dt);
  given_.configs.push_back(file("none.yaml", "mpc: {time_budget: 0}\n"));
  EXPECT_EQ(read().mpc.time_budget, 0.0);
  given_.set("mpc/time_budget", 0.04);
  EXPECT_EQ(read().mpc.time_budget, 0.04);
}

/// The values of model/max_torque, mpc/max_torque and controller/torque_dim as YAML.
std::vector<std::string> learnersMotors(const Arguments& given) {
  const YAML::Node blocks = resolve(given).blocks;
  std::vector<std::string> out;
  for (const YAML::Node& value : {blocks["model"]["max_torque"], blocks["mpc"]["max_torque"],
                                  blocks["controller"]["torque_dim"]}) {
    out.push_back(YAML::Dump(value));
  }
  return out;
}

TEST_F(Resolution, ALearnerKnowsTheMotorsOfItsRobotOrElseOfItsPlant) {
  struct Case {
    std::string plant, blocks;
    std::vector<std::string> motors;
  };
  const std::string with_gravity = "pendulum_gravity";
  const std::string plain = file("plain.yaml", "plant: {type: two_link}\n");  // names no motors
  for (const Case& c : std::vector<Case>{
           {"pendulum", "", {"6.0", "6.0", "1"}},
           {"moving_tile", "", {"5.0", "5.0", "2"}},
           {"two_link", "", {"[4.0, 2.0]", "[4.0, 2.0]", "2"}},
           {plain, "", {"[4.0, 2.0]", "[4.0, 2.0]", "2"}},
           {with_gravity, "", {"2.5", "2.5", "1"}},
           {with_gravity, "plant: {max_torque: 3}", {"3.0", "3.0", "1"}},
           {with_gravity, "{plant: {max_torque: 3}, mpc: {max_torque: 1}}", {"3.0", "1", "1"}},
           {with_gravity, "{model: {max_torque: 4}, mpc: {max_torque: 1}}", {"4", "1", "1"}},
           {with_gravity, "robot: {max_torque: 2}", {"2", "2", "1"}},
           {with_gravity, "robot: {max_torque: [4, 2]}", {"[4, 2]", "[4, 2]", "2"}}}) {
    given_.set("experiment/plant", c.plant);
    given_.configs = {file("blocks.yaml", c.blocks)};
    EXPECT_EQ(learnersMotors(given_), c.motors) << c.plant << ", " << c.blocks;
    EXPECT_EQ(YAML::Dump(resolve(given_).blocks).find('&'), std::string::npos) << "no aliases";
  }
  given_.set("controller/torque_dim", 2);
  EXPECT_NO_THROW(resolve(given_));
  given_.set("controller/torque_dim", 3);
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([this] { resolve(given_); },
                                                  {"controller/torque_dim", "robot", "got 3"}));
  given_.set("controller/torque_dim", std::string("two"));
  EXPECT_EQ(learnersMotors(given_)[2], "two") << "for the reader to refuse";
}

TEST_F(Resolution, BadMotorsOfAPlantAreLeftToTheReader) {
  given_.set("experiment/plant", std::string("two_link"));
  given_.configs = {file("none.yaml", "plant: {max_torque: []}\n")};
  EXPECT_EQ(learnersMotors(given_)[2], "1");
  given_.configs = {file("bad.yaml", "plant: {no_key: 1}\n")};
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([this] { read(); }, {"plant/no_key"}));
}

TEST_F(Resolution, ABlockThatIsNotAMapIsLeftToTheReader) {
  given_.configs = {
      file("robot.yaml", "robot: {max_torque: 2}\nmodel: 3\nmpc: [1]\nexperiment: 3\n")};
  EXPECT_TRUE(
      throwsNaming<std::invalid_argument>([this] { read(); }, {"model", "mpc", "experiment"}));
}

TEST_F(Resolution, ASavedConfigurationIsNotMixedWithAnotherPlantPresetOrMethod) {
  given_.set("experiment/plant", std::string("pendulum_gravity"));
  const std::string config = saved();
  for (const auto& [kind, name] :
       {std::make_pair("plant", "pendulum"), {"preset", "debug"}, {"method", "oracle"}}) {
    given_ = Arguments();
    given_.configs = {config};
    given_.set(std::string("experiment/") + kind, std::string(name));
    EXPECT_TRUE(throwsNaming<std::invalid_argument>([this] { read(); },
                                                    {config, std::string("not ") + name, "leave"}));
  }
  given_ = Arguments();
  given_.configs = {"nuisance/noise", config};
  given_.set("experiment/plant", std::string("pendulum_gravity"));
  EXPECT_EQ(gravity(read()), 9.82);
  EXPECT_EQ(read().camera.noise_std, 0.1) << "a saved configuration is the base of all others";
}

TEST_F(Resolution, AnotherModelOrOtherBagsBringTheirOwnChecksums) {
  given_.configs = {file(
      "start.yaml", "start: {model: /a.ddm, bags: [/a.bag], checksums: [crc32-1, crc32-2]}\n")};
  EXPECT_EQ(read().start.checksums.size(), 2u);
  given_.set("start/model", std::string("/b.ddm"));
  EXPECT_EQ(read().start.model, "/b.ddm");
  EXPECT_TRUE(read().start.checksums.empty());
}

}  // namespace
}  // namespace ddm
