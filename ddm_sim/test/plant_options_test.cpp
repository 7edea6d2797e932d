// Tests of plant options: valid ranges, types of plants, and defaults in the shipped YAML files.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_options.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_common/param_reader.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/not_finite.h"
#include "ddm_msgs/testing/parameter_reference.h"
#include "ddm_plant_plugin/plant_config.h"
#include "ddm_sim/camera.h"
#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"
#include "ddm_sim/plant.h"
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

/// Sets each number, and each number of each list, to `value` in turn.
/// @return the keys for which that is no problem
template <class Options>
std::set<std::string> accepted(double value) {
  std::set<std::string> out;
  const YAML::Node defaults = toYaml(Options());
  for (const auto& entry : defaults) {
    const auto key = entry.first.as<std::string>();
    const bool is_list = entry.second.IsSequence();
    double number = 0.0;
    if (!is_list && !parseValue(entry.second, &number)) continue;
    for (std::size_t i = 0; i < (is_list ? entry.second.size() : 1); ++i) {
      YAML::Node blocks;
      blocks["block"] = YAML::Clone(defaults);
      YAML::Node changed = blocks["block"][key];
      if (is_list) changed[i] = valueToYaml(value);
      if (!is_list) changed = valueToYaml(value);
      ParamReader reader(blocks);
      reader.read<Options>("block");
      if (reader.problems().empty()) out.insert(key);
    }
  }
  return out;
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

TEST(PlantOptions, GiveEachComponentItsNumberOrAllTheSame) {
  EXPECT_EQ(forEach({2.5}, 3, "key"), Eigen::Vector3d::Constant(2.5));
  EXPECT_EQ(forEach({1.0, 2.0, 3.0}, 3, "key"), Eigen::Vector3d(1.0, 2.0, 3.0));
  for (const std::vector<double>& bad : {std::vector<double>{}, std::vector<double>{1.0, 2.0}}) {
    EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
        [&] { forEach(bad, 3, "plant/key"); }, {"plant/key", std::to_string(bad.size())}));
  }
}

TEST(CameraOptions, ReportEachNuisanceOutOfRange) {
  CameraOptions options;
  options.noise_std = 1.5;
  options.brightness_drift = 1.0;
  options.clutter = 1.25;
  options.delay = 1001;
  options.drop_rate = 0.5;
  EXPECT_EQ(options.problems().size(), 5U);
  options = CameraOptions();
  options.delay = -1;
  EXPECT_EQ(options.problems().size(), 1U);
}

std::shared_ptr<const PlantPlugin> plantOfText(const std::string& text) {
  ParamReader reader(YAML::Load(text));
  auto plant = readPlant(&reader);
  reader.requireValid();
  return plant;
}

TEST(PlantRegistry, ReadsThePlantThatItsTypeNamesWithItsOwnKeys) {
  EXPECT_EQ(yaml(plantOfText("{}")->block()), yaml(PendulumOptions()));
  EXPECT_EQ(yaml(plantOfText("plant: {type: moving_tile}")->block()), yaml(MovingTileOptions()));
  EXPECT_EQ(yaml(plantOfText("plant: {type: two_link}")->block()), yaml(TwoLinkOptions()));
  const auto tile = plantOfText("plant: {type: moving_tile, image_size: 30, max_torque: [3, 4]}");
  EXPECT_EQ(tile->type(), "moving_tile");
  EXPECT_EQ(tile->block()["image_size"].as<int>(), 30);
  EXPECT_EQ(tile->make()->info().max_torque, Eigen::Vector2d(3.0, 4.0));
}

TEST(ParameterReferences, HaveTheDefaultsOfTheStructs) {
  testing::expectDefaults<CameraOptions>(kConfig + "sim.yaml", "camera");
  testing::expectDefaults<SimOptions>(kConfig + "sim.yaml", "sim");
  testing::expectDefaults<ShowOptions>(kConfig + "sim.yaml", "show");
  for (const auto& [file, expected] : {std::make_pair("pendulum.yaml", yaml(PendulumOptions())),
                                       std::make_pair("two_link.yaml", yaml(TwoLinkOptions()))}) {
    ParamReader reader = ParamReader::fromFiles({kConfig + file});
    EXPECT_EQ(yaml(readPlant(&reader)->block()), expected);
    reader.requireValid();
  }
  EXPECT_EQ(YAML::LoadFile(kConfig + "pendulum.yaml")["plant"].size(),
            toYaml(PendulumOptions()).size());
}

}  // namespace
}  // namespace ddm
