// Tests of the options: valid ranges, and that the shipped YAML files say what the structs say.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "ddm_params/param_reader.h"
#include "ddm_sim/plant_factory.h"
#include "show_options.h"

namespace ddm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kConfig = std::string(DDM_SIM_SOURCE_DIR) + "/config/";

template <class Options>
std::string yaml(const Options& options) {
  return YAML::Dump(toYaml(options));
}

template <class Options>
std::set<std::string> keys(Options options) {
  std::set<std::string> out;
  auto collect = [&out](const std::string& key, const auto&) { out.insert(key); };
  options.visit(collect);
  return out;
}

std::set<std::string> keys(const YAML::Node& block) {
  std::set<std::string> out;
  for (const auto& entry : block) out.insert(entry.first.as<std::string>());
  return out;
}

/// Sets each key of type double to `value` in turn and counts how often that is no problem.
template <class Options>
int numAccepted(double value) {
  int accepted = 0;
  for (const std::string& name : keys(Options())) {
    Options options;
    bool is_double = false;
    auto set = [&](const std::string& key, auto& member) {
      if constexpr (std::is_same_v<decltype(member), double&>) {
        if (key == name) {
          member = value;
          is_double = true;
        }
      }
    };
    options.visit(set);
    if (is_double && options.problems().empty()) ++accepted;
  }
  return accepted;
}

TEST(PlantOptions, DefaultsAreValid) {
  EXPECT_TRUE(PlantOptions().problems().empty());
  EXPECT_TRUE(CameraOptions().problems().empty());
  EXPECT_TRUE(SimOptions().problems().empty());
}

TEST(PlantOptions, RefuseNaNInfinityAndNegativeNumbersInEveryKey) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, -1.0}) {
    EXPECT_EQ(numAccepted<PlantOptions>(bad), 0) << bad;
    EXPECT_EQ(numAccepted<CameraOptions>(bad), 0) << bad;
    EXPECT_EQ(numAccepted<SimOptions>(bad), 0) << bad;
  }
}

TEST(ShowOptions, RefuseAFrameRateThatWouldNeverShowAFrame) {
  EXPECT_TRUE(ShowOptions().problems().empty());
  for (const double rate : {0.5, 1e-9, 2e6, -25.0, kNaN}) {
    EXPECT_EQ(ShowOptions{rate}.problems().size(), 1U) << rate;
  }
  for (const double rate : {0.0, 1.0, 25.0}) {
    EXPECT_TRUE(ShowOptions{rate}.problems().empty()) << rate;
  }
}

TEST(PlantOptions, AllowNoGravityNoFrictionAndNoSpread) {
  PlantOptions options;
  options.gravity = options.friction = options.start_std = 0.0;
  EXPECT_TRUE(options.problems().empty());
}

TEST(PlantOptions, ReportEachProblemWithKeyRuleAndValue) {
  PlantOptions options;
  options.length = -2.5;
  options.type = "cart";
  const std::vector<std::string> expected{
      "plant/type must be one of: pendulum, moving_tile, or PACKAGE/CLASS of a plugin, got "
      "\"cart\"",
      "plant/length must be > 0 and finite, got -2.5"};
  EXPECT_EQ(options.problems(), expected);
}

TEST(PlantOptions, ReportAnImageSizeOutOfRange) {
  for (const int size : {-1, 0, 3, 1025}) {
    CameraOptions options;
    options.size = size;
    ASSERT_EQ(options.problems().size(), 1U);
    EXPECT_EQ(options.problems()[0],
              "camera/size must lie in [4, 1024] pixels, got " + std::to_string(size));
  }
}

TEST(CameraOptions, AllowEachNuisanceUpToItsLimit) {
  CameraOptions options;
  options.noise_std = options.clutter = 1.0;
  options.brightness_drift = std::nextafter(1.0, 0.0);
  options.delay = 1000;
  options.drop_rate = 0.3;
  EXPECT_TRUE(options.problems().empty());
}

TEST(CameraOptions, ReportEachNuisanceOutOfRange) {
  CameraOptions options;
  options.noise_std = 1.5;
  options.brightness_drift = 1.0;
  options.brightness_period = 0.0;
  options.clutter = 1.25;
  options.clutter_seed = -1;
  options.delay = 1001;
  options.drop_rate = 0.5;
  const std::vector<std::string> expected{"camera/noise_std must lie in [0, 1], got 1.5",
                                          "camera/brightness_drift must lie in [0, 1), got 1",
                                          "camera/brightness_period must be > 0 and finite, got 0",
                                          "camera/clutter must lie in [0, 1], got 1.25",
                                          "camera/clutter_seed must be >= 0, got -1",
                                          "camera/delay must lie in [0, 1000] frames, got 1001",
                                          "camera/drop_rate must lie in [0, 0.3], got 0.5"};
  EXPECT_EQ(options.problems(), expected);
  options = CameraOptions();
  options.delay = -1;
  EXPECT_EQ(options.problems().size(), 1U);
}

TEST(PlantFactory, RefusesAnUnknownTypeAndListsTheKnownOnes) {
  PlantOptions options;
  options.type = "cart";
  try {
    makePlant(options, CameraOptions());
    FAIL() << "a cart was made";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("pendulum, moving_tile"), std::string::npos) << e.what();
  }
}

TEST(PlantFactory, ReportsAnUnknownTypeTogetherWithAllOtherProblems) {
  PlantOptions options;
  options.type = "cart";
  options.tile_width = 0.0;
  CameraOptions camera;
  camera.size = 0;
  try {
    makePlant(options, camera);
    FAIL() << "a cart was made";
  } catch (const std::invalid_argument& e) {
    for (const char* key : {"plant/type", "plant/tile_width", "camera/size"}) {
      EXPECT_NE(std::string(e.what()).find(key), std::string::npos) << e.what();
    }
  }
}

TEST(PlantFactory, MakesEveryTypeItKnows) {
  std::set<std::vector<std::string>> states;
  for (const std::string& type : plantTypes()) {
    PlantOptions options;
    options.type = type;
    states.insert(makePlant(options, CameraOptions())->stateNames());
  }
  const std::set<std::vector<std::string>> expected{{"angle_rad", "rate_rad_per_s"},
                                                    {"x_px", "y_px"}};
  EXPECT_EQ(states, expected);
}

TEST(PlantFactory, LeavesThePlantOfAnotherPackageToItsMaker) {
  struct TileMaker : PlantMaker {
    std::unique_ptr<Plant> make(const CameraOptions& camera) const override {
      PlantOptions tile;
      tile.type = "moving_tile";
      return makePlant(tile, camera);
    }
  };
  PlantOptions options;
  options.type = "their_package/Tile";
  options.maker = std::make_shared<TileMaker>();
  CameraOptions camera;
  camera.size = 20;
  const auto plant = makePlant(options, camera);
  EXPECT_EQ(plant->stateNames(), (std::vector<std::string>{"x_px", "y_px"}));
  EXPECT_EQ(plant->imageSize(), 20);
}

TEST(Config, ManualSaysWhatTheStructsSay) {
  // The moving tile's first, so that of its values the one that it explains alone stays.
  auto reader = ParamReader::fromFiles(
      {kConfig + "moving_tile.yaml", kConfig + "pendulum.yaml", kConfig + "sim.yaml"});
  const auto plant = reader.read<PlantOptions>("plant");
  const auto camera = reader.read<CameraOptions>("camera");
  const auto sim = reader.read<SimOptions>("sim");
  const auto show = reader.read<ShowOptions>("show");
  ASSERT_NO_THROW(reader.requireValid());
  EXPECT_EQ(yaml(plant), yaml(PlantOptions()));
  EXPECT_EQ(yaml(camera), yaml(CameraOptions()));
  EXPECT_EQ(yaml(sim), yaml(SimOptions()));
  EXPECT_EQ(yaml(show), yaml(ShowOptions()));
}

TEST(Config, ManualNamesEveryKeyOnce) {
  const YAML::Node sim = YAML::LoadFile(kConfig + "sim.yaml");
  std::set<std::string> explained = keys(YAML::LoadFile(kConfig + "pendulum.yaml")["plant"]);
  EXPECT_EQ(explained.count("tile_width"), 0U);  // moving_tile.yaml explains it
  explained.insert("tile_width");
  explained.insert("tile_softness");
  EXPECT_EQ(explained, keys(PlantOptions()));
  EXPECT_EQ(keys(YAML::LoadFile(kConfig + "moving_tile.yaml")["plant"]).count("tile_width"), 1U);
  EXPECT_EQ(keys(sim["camera"]), keys(CameraOptions()));
  EXPECT_EQ(keys(sim["sim"]), keys(SimOptions()));
  EXPECT_EQ(keys(sim["show"]), keys(ShowOptions()));
}

TEST(Config, PendulumGravityIsTheClassicalHardOne) {
  auto reader = ParamReader::fromFiles({kConfig + "pendulum_gravity.yaml"});
  const auto plant = reader.read<PlantOptions>("plant");
  ASSERT_NO_THROW(reader.requireValid());
  EXPECT_EQ(plant.gravity, 9.82);
  EXPECT_EQ(plant.friction, 0.01);
  EXPECT_EQ(plant.max_torque, 2.5);
  EXPECT_EQ(plant.dt, 0.1);
}

TEST(Config, MovingTileIsThatOfTheExperiments) {
  auto reader = ParamReader::fromFiles({kConfig + "moving_tile.yaml"});
  const auto plant = reader.read<PlantOptions>("plant");
  ASSERT_NO_THROW(reader.requireValid());
  EXPECT_EQ(plant.type, "moving_tile");
  EXPECT_EQ(plant.tile_width, 9.0);
  EXPECT_EQ(plant.tile_softness, 9.0);
  EXPECT_EQ(plant.max_torque, 5.0);
  EXPECT_EQ(plant.dt, 0.2);
  EXPECT_EQ(plant.start_std, 5.0);
}

TEST(Config, TellsALearnerTheTorqueLimitOfTheSamePlant) {
  for (const char* name : {"pendulum_gravity.yaml", "moving_tile.yaml"}) {
    const YAML::Node config = YAML::LoadFile(kConfig + name);
    for (const char* block : {"mpc", "model"}) {
      EXPECT_EQ(config[block]["max_torque"].as<double>(),
                config["plant"]["max_torque"].as<double>())
          << name << ": " << block;
    }
  }
}

TEST(Config, TellsALearnerTheNumberOfTorquesOfTheMovingTile) {
  auto reader = ParamReader::fromFiles({kConfig + "moving_tile.yaml"});
  const auto plant = makePlant(reader.read<PlantOptions>("plant"), CameraOptions());
  const YAML::Node config = YAML::LoadFile(kConfig + "moving_tile.yaml");
  EXPECT_EQ(config["controller"]["torque_dim"].as<int>(), plant->torqueDim());
}

}  // namespace
}  // namespace ddm
