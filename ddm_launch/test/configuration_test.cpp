// Tests of the configuration: all files of the packages load, and contradictions are refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <ddm_common/param_reader.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/parameter_reference.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <ddm_sim/plant.h>
#include <ddm_sim/rod_renderer.h>
#include <gtest/gtest.h>

#include <boost/filesystem.hpp>

#include "method.h"
#include "resolution.h"
#include "toy_run.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using testing::TempFolder;
using testing::throwsNaming;
using testing::writeText;

const char kPresets[] = DDM_LAUNCH_SOURCE_DIR "/config/presets";

/// Names of the YAML files in a folder.
std::vector<std::string> namesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  return names;
}

Configuration read(const Arguments& arguments) {
  ParamReader reader = resolve(arguments).reader();
  return readConfiguration(&reader);
}

/// The arguments --preset, --plant and --config.
Arguments arguments(const std::string& preset, const std::string& plant,
                    const std::vector<std::string>& configs = {}) {
  Arguments given;
  given.set("experiment/preset", preset);
  given.set("experiment/plant", plant);
  given.configs = configs;
  return given;
}

/// Reads a configuration with the blocks of a YAML text as an additional layer.
Configuration readText(const std::string& text, const std::string& preset = "paper") {
  const TempFolder folder;
  writeText(folder.file("differs.yaml"), text);
  return read(arguments(preset, "pendulum", {folder.file("differs.yaml")}));
}

TEST(Configuration, EveryPresetLoadsWithEveryPlant) {
  const std::vector<std::string> presets = namesIn(kPresets);
  ASSERT_GE(presets.size(), 2u);
  for (const std::string& preset : presets) {
    for (const std::string plant : {"moving_tile", "pendulum", "pendulum_gravity"}) {
      EXPECT_NO_THROW(read(arguments(preset, plant))) << preset << ", " << plant;
    }
  }
}

TEST(Configuration, ThePaperPresetHoldsTheNumbersOfThePaper) {
  const Configuration all = read(arguments("paper", "pendulum"));
  EXPECT_EQ(all.model.image.size, 51);
  EXPECT_EQ(all.model.model.pca_dim, 50);
  EXPECT_EQ(all.model.model.feature_dim, 2);
  EXPECT_EQ(all.model.model.order, 2);
  EXPECT_EQ(all.model.model.encoder_widths, (std::vector<int>{25, 12, 6}));
  EXPECT_EQ(all.model.model.predictor_widths, (std::vector<int>{4}));
  EXPECT_EQ(all.model.model.predictor, "network");
  EXPECT_EQ(all.model.training.prediction_steps, 1);
  EXPECT_EQ(all.model.training.weight_decay, 0.0);
  EXPECT_EQ(all.model.training.num_starts, 1);
  EXPECT_EQ(all.mpc.offset_gain, 0.0);
  EXPECT_EQ(all.mpc.horizon, 15);
  EXPECT_EQ(all.mpc.control_weight, 0.01);
  EXPECT_EQ(all.mpc.epsilon, 0.2);
  EXPECT_EQ(all.experiment.trials, 15);
  EXPECT_EQ(all.trial.num_steps, 100);
  EXPECT_EQ(all.plant_info.dt, 0.2);
  for (const char* key : {"length", "mass", "friction"}) {
    EXPECT_EQ(all.plant->block()[key].as<double>(), 1.0) << key;
  }
  EXPECT_EQ(all.plant_info.tolerance, 10.0);
}

TEST(Configuration, PresetUnderactuatedHasTheModelOfPresetEfficient) {
  const auto modelOf = [](const std::string& preset) {
    return YAML::Dump(toYaml(read(arguments(preset, "pendulum")).model.model));
  };
  EXPECT_EQ(modelOf("underactuated"), modelOf("efficient"));
}

TEST(Configuration, ANameThatDoesNotExistIsRefusedWithThoseThatDo) {
  const auto refused = [](const Arguments& given, const std::vector<std::string>& words) {
    return throwsNaming<std::invalid_argument>([&] { read(given); }, words);
  };
  for (const std::string name : {"nuisance/fog", "noise", "noise/noise"}) {
    EXPECT_TRUE(refused(arguments("paper", "pendulum", {name}),
                        {"'" + name + "'", "nuisance/clutter", "oracle/suite_reacher"}));
  }
  EXPECT_TRUE(refused(arguments("paper", "moving_tile", {"nuisance/thin_rod"}),
                      {"plant/rod_half_width"}));  // only plants with a rod have one to make thin
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([] { methodKind("oracel"); },
                                                  {"unknown method 'oracel'", "ddm, oracle"}));
  // sim.yaml is in the same folder but describes no plant.
  for (const std::string plant : {"pendulumm", "sim", "", "../config/pendulum"}) {
    EXPECT_TRUE(refused(arguments("paper", plant),
                        {"'" + plant + "'", "moving_tile",
                         "mujoco_pendulum, pendulum, pendulum_gravity", "two_link"}))
        << plant;
  }
}

TEST(Configuration, EveryNamedConfigurationIsReadAndChangesSomething) {
  const std::string plain = YAML::Dump(toYaml(read(arguments("efficient", "pendulum"))));
  const YAML::Node all = YAML::LoadFile(DDM_LAUNCH_SOURCE_DIR "/config/named.yaml");
  for (const auto& group : all) {
    for (const auto& one : group.second) {
      const std::string name = one.first.Scalar(), full = group.first.Scalar() + "/" + name;
      if (group.first.Scalar() == "oracle") {
        EXPECT_NO_THROW(plantFile(name)) << full;
      }
      if (group.first.Scalar() == "launch") continue;
      EXPECT_NE(YAML::Dump(toYaml(read(arguments("efficient", "pendulum", {full})))), plain)
          << full;
    }
  }
}

TEST(Configuration, ProblemsOfAllBlocksAreReportedAtOnce) {
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [] {
        readText(
            "mpc: {horzion: 3, epsilon: 1.5}\ntrial: {num_steps: 0}\n"
            "experiment: {seed: -1, trials: 1000, timeout: 0}\n"
            "evaluation: {goal_distance: .nan}\nplant: {dt: fast}\n"
            "model: {order: 2.5}\nsin: {watchdog: 1}\n");
      },
      {"differs.yaml", "\n - unknown key mpc/horzion (did you mean horizon? known keys: horizon, ",
       "\n - mpc/epsilon", "1.5", "experiment/seed", "-1", "experiment/trials", "1000",
       "experiment/timeout", "trial/num_steps", "evaluation/goal_distance", "nan", "plant/dt",
       "fast", "model/order", "2.5", "block sin (did you mean sim?"}));
}

TEST(Configuration, WhatContradictsIsRefused) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> contradictions = {
      {"mpc: {max_torque: 6.5}\nmodel: {max_torque: 7.0}",
       {"mpc/max_torque", "plant/max_torque", "got 6.5"}},
      {"mpc: {max_torque: 6.0}\nmodel: {max_torque: 5.0}",
       {"mpc/max_torque", "model/max_torque", "got 6"}},
      {"mpc: {max_torque: 3.5}\nrobot: {max_torque: 3.0}",
       {"mpc/max_torque", "robot/max_torque", "got 3.5"}},
      {"mpc: {cost: time}\nrobot: {max_torque: [6, 6, 6, 6, 6, 6]}",
       {"mpc/cost must be distance", "more than 3 motors",
        "got time with the 6 of robot/max_torque"}},
      {"mpc: {time_budget: 0.3}", {"mpc/time_budget", "plant/dt", "got 0.3"}},
      {"mpc: {time_budget: 0.15}\nrobot: {dt: 0.1}", {"mpc/time_budget", "robot/dt", "got 0.15"}},
      {"mpc: {max_torque: 8.0}\ntrial: {num_steps: 50}",
       {"plant/max_torque", "model/max_torque", "trial/num_steps", "model/pca_dim", "got 50"}},
      {"trial: {num_steps: 25, episodes: 2}", {"trial/episodes", "model/pca_dim", "got 50"}},
      {"trial: {num_steps: 30}\nmodel: {pca_dim: 10, order: 30}",
       {"trial/num_steps", "model/order", "got 30"}}};
  for (const auto& contradiction : contradictions) {
    EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { readText(contradiction.first); },
                                                    contradiction.second))
        << contradiction.first;
  }
}

TEST(Configuration, ARobotIsOneWhereItsBlockIsGiven) {
  EXPECT_FALSE(readText("mpc: {horizon: 3}\n").robot.has_value());
  const Configuration robot =
      readText("robot: {dt: 0.1, max_torque: 8.0}\nmpc: {max_torque: 7.0}\n");
  ASSERT_TRUE(robot.robot.has_value());
  EXPECT_EQ(toYaml(robot)["robot"]["dt"].as<double>(), 0.1);
}

TEST(Configuration, EachMotorBoundsWhatIsPlannedForIt) {
  const TempFolder folder;
  const auto readTile = [&](const std::string& limits, const std::string& planned) {
    writeText(folder.file("limits.yaml"), "plant: {type: moving_tile, max_torque: " + limits +
                                              "}\nmpc: {max_torque: " + planned + "}\n");
    return read(arguments("paper", "moving_tile", {folder.file("limits.yaml")}));
  };
  EXPECT_EQ(readTile("[5.0, 4.0]", "4.0").plant_info.max_torque, Eigen::Vector2d(5.0, 4.0));
  EXPECT_NO_THROW(readTile("[5.0, 4.0]", "[5.0, 4.0]"));
  for (const char* planned : {"4.1", "[3.5, 4.1]"}) {
    EXPECT_TRUE(throwsNaming<std::invalid_argument>(
        [&] { readTile("[5.0, 4.0]", planned); }, {"mpc/max_torque", "plant/max_torque", planned}));
  }
}

TEST(Configuration, WhatJustFitsIsAccepted) {
  EXPECT_NO_THROW(readText("trial: {num_steps: 51}\n"));
  EXPECT_NO_THROW(readText("trial: {num_steps: 30}\nmodel: {pca_dim: 10, order: 29}\n"));
  EXPECT_NO_THROW(readText("mpc: {time_budget: 0.2}\n"));
  EXPECT_NO_THROW(readText("mpc: {cost: time}\nrobot: {max_torque: [6, 6, 6]}\n"));
  EXPECT_NO_THROW(readText("robot: {max_torque: [6, 6, 6, 6, 6, 6]}\n"));  // the cost is `distance`
}

TEST(ParameterReferences, HaveBlocksThatEveryProgramLeavesAlone) {
  for (const char* package : {"ddm_launch", "ddm_model", "ddm_mpc", "ddm_sim"}) {
    const std::string folder = std::string(DDM_LAUNCH_SOURCE_DIR "/../") + package + "/config/";
    for (const std::string& name : namesIn(folder)) {
      if (name == "named") continue;  // contains named configurations, not blocks
      const ParamReader reader = ParamReader::fromFiles({folder + name + ".yaml"});
      EXPECT_EQ(reader.problems(), std::vector<std::string>()) << folder << name;
    }
  }
}

TEST(ExperimentReference, HasTheKeysAndDefaultsOfEachBlock) {
  const std::string file = DDM_LAUNCH_SOURCE_DIR "/config/experiment.yaml";
  testing::expectDefaults<ExperimentOptions>(file, "experiment");
  testing::expectDefaults<TrialOptions>(file, "trial");
  testing::expectDefaults<EvaluationOptions>(file, "evaluation");
  testing::expectDefaults<StartOptions>(file, "start");
}

}  // namespace
}  // namespace ddm
