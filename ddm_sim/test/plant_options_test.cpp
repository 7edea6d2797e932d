// Tests of the options: valid ranges, the registry of plants, shipped YAML files like the structs.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "ddm_msgs/testing/not_finite.h"
#include "ddm_params/param_reader.h"
#include "ddm_plant_plugin/plant_config.h"
#include "ddm_sim/camera_options.h"
#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"
#include "ddm_sim/plant_factory.h"
#include "ddm_sim/sim_options.h"
#include "ddm_sim/two_link.h"

namespace ddm {
namespace {

const std::string kConfig = std::string(DDM_SIM_SOURCE_DIR) + "/config/";

template <class Options>
std::string yaml(const Options& options) {
  return YAML::Dump(toYaml(options));
}

std::string yaml(const YAML::Node& block) { return YAML::Dump(block); }

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

/// Sets each number, and each number of each list, to `value` in turn.
/// @return the keys for which that is no problem
template <class Options>
std::set<std::string> accepted(double value) {
  std::set<std::string> out;
  Options sound;
  auto each = [&](const std::string& name, auto& example) {
    constexpr bool kList = std::is_same_v<decltype(example), std::vector<double>&>;
    constexpr bool kNumber = std::is_same_v<decltype(example), double&>;
    if constexpr (kList || kNumber) {
      std::size_t count = 1;
      if constexpr (kList) count = example.size();
      for (std::size_t i = 0; i < count; ++i) {
        Options options;
        auto set = [&](const std::string& key, auto& member) {
          if (key != name) return;
          if constexpr (std::is_same_v<decltype(member), double&>) member = value;
          if constexpr (std::is_same_v<decltype(member), std::vector<double>&>) member[i] = value;
        };
        options.visit(set);
        if (options.problems().empty()) out.insert(name);
      }
    }
  };
  sound.visit(each);
  return out;
}

/// Whether one of the problems begins with the key.
template <class Options>
bool blames(const Options& options, const std::string& key) {
  const std::vector<std::string> problems = options.problems();
  return std::any_of(problems.begin(), problems.end(), [&key](const std::string& problem) {
    return problem.rfind(key + " ", 0) == 0;
  });
}

TEST(PlantOptions, DefaultsAreValid) {
  EXPECT_TRUE(PendulumOptions().problems().empty());
  EXPECT_TRUE(MovingTileOptions().problems().empty());
  EXPECT_TRUE(TwoLinkOptions().problems().empty());
  EXPECT_TRUE(CameraOptions().problems().empty());
  EXPECT_TRUE(SimOptions().problems().empty());
}

TEST(PlantOptions, RefuseNaNInfinityAndNegativeNumbersInEveryKey) {
  const std::set<std::string> none;
  for (const double bad : {kNaN, kInfinity, -kInfinity, -1.0}) {
    EXPECT_EQ(accepted<PendulumOptions>(bad), none) << bad;
    EXPECT_EQ(accepted<MovingTileOptions>(bad), none) << bad;
    EXPECT_EQ(accepted<TwoLinkOptions>(bad), none) << bad;
    EXPECT_EQ(accepted<CameraOptions>(bad), none) << bad;
    EXPECT_EQ(accepted<SimOptions>(bad), none) << bad;
  }
}

TEST(PlantOptions, AllowNoGravityNoFrictionAndNoSpread) {
  EXPECT_EQ(accepted<PendulumOptions>(0.0),
            (std::set<std::string>{"friction", "gravity", "start_std"}));
  EXPECT_EQ(accepted<MovingTileOptions>(0.0), std::set<std::string>{"start_std"});
  EXPECT_EQ(accepted<TwoLinkOptions>(0.0),
            (std::set<std::string>{"friction", "gravity", "start_std"}));
}

TEST(PlantOptions, RefuseAnEmptyList) {
  PlantOptions options;
  options.max_torque.clear();
  options.start_std.clear();
  EXPECT_TRUE(blames(options, "plant/max_torque"));
  EXPECT_TRUE(blames(options, "plant/start_std"));
}

TEST(PlantOptions, GiveEachComponentItsNumberOrAllTheSame) {
  EXPECT_EQ(forEach({2.5}, 3, "key"), Eigen::Vector3d::Constant(2.5));
  EXPECT_EQ(forEach({1.0, 2.0, 3.0}, 3, "key"), Eigen::Vector3d(1.0, 2.0, 3.0));
  for (const std::vector<double>& bad : {std::vector<double>{}, std::vector<double>{1.0, 2.0}}) {
    try {
      forEach(bad, 3, "plant/key");
      FAIL() << bad.size() << " number(s) were taken for 3";
    } catch (const std::invalid_argument& e) {
      const std::string message = e.what();
      EXPECT_NE(message.find("plant/key"), std::string::npos) << message;
      EXPECT_NE(message.find(std::to_string(bad.size())), std::string::npos) << message;
    }
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

TEST(PlantOptions, ReportEachProblemWithKeyAndValue) {
  PendulumOptions options;
  options.length = -2.5;
  options.look.edge_softness = 0.0;
  EXPECT_EQ(options.problems().size(), 2U);
  EXPECT_TRUE(blames(options, "plant/length"));
  EXPECT_TRUE(blames(options, "plant/edge_softness"));
  EXPECT_NE(options.problems()[0].find("got -2.5"), std::string::npos);
}

TEST(PlantOptions, ReportAPictureSizeOutOfRange) {
  for (const int size : {-1, 0, 3, 1025}) {
    PlantOptions options;
    options.picture_size = size;
    EXPECT_TRUE(blames(options, "plant/picture_size")) << size;
  }
  for (const int size : {4, 1024}) {
    PlantOptions options;
    options.picture_size = size;
    EXPECT_TRUE(options.problems().empty()) << size;
  }
}

TEST(PlantOptions, ReportATimeStepThatNoCameraKeeps) {
  PlantOptions options;
  options.dt = 0.0009;
  EXPECT_TRUE(blames(options, "plant/dt"));
  options.dt = 10.1;
  EXPECT_TRUE(blames(options, "plant/dt"));
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
  EXPECT_EQ(options.problems().size(), 7U);
  for (const std::string& key : keys(options)) {
    EXPECT_TRUE(blames(options, "camera/" + key)) << key;
  }
  options = CameraOptions();
  options.delay = -1;
  EXPECT_EQ(options.problems().size(), 1U);
}

/// The plant that a file of the folder config/ describes.
std::shared_ptr<const PlantPlugin> plantOf(const std::vector<std::string>& files) {
  std::vector<std::string> paths;
  for (const std::string& file : files) paths.push_back(kConfig + file);
  ParamReader reader = ParamReader::fromFiles(paths);
  auto plant = readPlant(&reader);
  reader.requireValid();
  return plant;
}

std::shared_ptr<const PlantPlugin> plantOfText(const std::string& text) {
  ParamReader reader(YAML::Load(text));
  auto plant = readPlant(&reader);
  reader.requireValid();
  return plant;
}

std::string refusalOfText(const std::string& text) {
  try {
    plantOfText(text);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(PlantRegistry, ReadsThePlantThatItsTypeNamesWithItsOwnKeys) {
  EXPECT_EQ(yaml(plantOfText("{}")->block()), yaml(PendulumOptions()));
  EXPECT_EQ(yaml(plantOfText("plant: {type: moving_tile}")->block()), yaml(MovingTileOptions()));
  EXPECT_EQ(yaml(plantOfText("plant: {type: two_link}")->block()), yaml(TwoLinkOptions()));
  const auto tile = plantOfText("plant: {type: moving_tile, tile_width: 7.5, max_torque: [3, 4]}");
  EXPECT_EQ(tile->type(), "moving_tile");
  EXPECT_EQ(tile->block()["tile_width"].as<double>(), 7.5);
  EXPECT_EQ(tile->make()->info().max_torque, Eigen::Vector2d(3.0, 4.0));
}

TEST(PlantRegistry, ReadsWhatItHasWritten) {
  for (const char* file : {"pendulum_gravity.yaml", "moving_tile.yaml", "two_link.yaml"}) {
    YAML::Node block;
    block["plant"] = plantOf({file})->block();
    EXPECT_EQ(yaml(plantOfText(YAML::Dump(block))->block()), yaml(block["plant"])) << file;
  }
}

TEST(PlantRegistry, RefusesAnUnknownTypeAndListsTheKnownOnes) {
  const std::string text = refusalOfText("plant: {type: cart}");
  for (const char* part : {"plant/type", "cart", "moving_tile", "pendulum", "two_link"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
  }
}

TEST(PlantRegistry, RefusesTheKeysOfAnotherPlantAndReportsAllProblemsAtOnce) {
  const std::string text = refusalOfText("plant: {type: pendulum, tile_width: 9, mass: -1}");
  for (const char* key : {"plant/tile_width", "plant/mass"}) {
    EXPECT_NE(text.find(key), std::string::npos) << key << " is not in: " << text;
  }
  EXPECT_NE(refusalOfText("plant: {type: moving_tile, mass: 1}").find("plant/mass"),
            std::string::npos);
}

TEST(Config, ManualSaysWhatTheStructsSay) {
  ParamReader reader = ParamReader::fromFiles({kConfig + "sim.yaml"});
  const auto camera = reader.read<CameraOptions>("camera");
  const auto sim = reader.read<SimOptions>("sim");
  const auto show = reader.read<ShowOptions>("show");
  ASSERT_NO_THROW(reader.requireValid());
  EXPECT_EQ(yaml(plantOf({"pendulum.yaml"})->block()), yaml(PendulumOptions()));
  EXPECT_EQ(yaml(plantOf({"two_link.yaml"})->block()), yaml(TwoLinkOptions()));
  EXPECT_EQ(yaml(camera), yaml(CameraOptions()));
  EXPECT_EQ(yaml(sim), yaml(SimOptions()));
  EXPECT_EQ(yaml(show), yaml(ShowOptions()));
}

TEST(Config, ManualNamesEveryKeyOnce) {
  const YAML::Node sim = YAML::LoadFile(kConfig + "sim.yaml");
  std::set<std::string> explained = keys(YAML::LoadFile(kConfig + "pendulum.yaml")["plant"]);
  EXPECT_EQ(explained, keys(PendulumOptions()));
  for (const char* file : {"moving_tile.yaml", "two_link.yaml"}) {
    const auto more = keys(YAML::LoadFile(kConfig + file)["plant"]);
    explained.insert(more.begin(), more.end());
  }
  for (const auto& block : {keys(MovingTileOptions()), keys(TwoLinkOptions())}) {
    for (const std::string& key : block) EXPECT_EQ(explained.count(key), 1U) << key;
  }
  EXPECT_EQ(keys(sim["camera"]), keys(CameraOptions()));
  EXPECT_EQ(keys(sim["sim"]), keys(SimOptions()));
  EXPECT_EQ(keys(sim["show"]), keys(ShowOptions()));
}

TEST(Config, PendulumGravityIsTheClassicalHardOne) {
  const YAML::Node plant = plantOf({"pendulum_gravity.yaml"})->block();
  EXPECT_EQ(plant["type"].as<std::string>(), "pendulum");
  EXPECT_EQ(plant["gravity"].as<double>(), 9.82);
  EXPECT_EQ(plant["friction"].as<double>(), 0.01);
  EXPECT_EQ(plantOf({"pendulum_gravity.yaml"})->make()->info().max_torque[0], 2.5);
  EXPECT_EQ(plant["dt"].as<double>(), 0.1);
}

TEST(Config, MovingTileIsThatOfTheExperiments) {
  const auto plugin = plantOf({"moving_tile.yaml"});
  EXPECT_EQ(plugin->block()["tile_width"].as<double>(), 9.0);
  EXPECT_EQ(plugin->block()["tile_softness"].as<double>(), 9.0);
  const PlantInfo info = plugin->make()->info();
  EXPECT_EQ(info.max_torque, Eigen::Vector2d(5.0, 5.0));
  EXPECT_EQ(info.start_std, Eigen::Vector2d(5.0, 5.0));
  EXPECT_EQ(info.dt, 0.2);
}

TEST(Config, TwoLinkIsThatOfTheIssue) {
  const auto plugin = plantOf({"two_link.yaml"});
  const YAML::Node block = plugin->block();
  using List = std::vector<double>;
  EXPECT_EQ(block["length"].as<List>(), (List{0.5, 0.5}));
  EXPECT_EQ(block["mass"].as<List>(), (List{1.0, 1.0}));
  EXPECT_EQ(block["friction"].as<List>(), (List{0.5, 0.15}));
  EXPECT_EQ(block["gravity"].as<double>(), 0.0);
  const PlantInfo info = plugin->make()->info();
  EXPECT_EQ(info.max_torque, Eigen::Vector2d(4.0, 2.0));
  EXPECT_EQ(info.start_std, Eigen::Vector4d::Constant(0.1));
  EXPECT_EQ(info.dt, 0.2);
  EXPECT_EQ(info.tolerance, 10.0);
}

TEST(Config, TellsALearnerTheNumberOfTorquesOfTheMovingTile) {
  const YAML::Node config = YAML::LoadFile(kConfig + "moving_tile.yaml");
  EXPECT_EQ(config["controller"]["torque_dim"].as<int>(),
            plantOf({"moving_tile.yaml"})->make()->torqueDim());
}

}  // namespace
}  // namespace ddm
