// Tests of keys that have another name today: where they move, and what stays to be refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_params/renamed_keys.h"

#include <gtest/gtest.h>

#include <string>

#include "ddm_params/config_blocks.h"

namespace ddm {
namespace {

/// In flow style, so that texts can be compared.
std::string dumped(YAML::Node node) {
  YAML::Emitter out;
  out << YAML::Flow << node;
  return out.c_str();
}

/// Keys of today of a YAML text, as text.
std::string today(const std::string& text) { return dumped(withTodaysKeys(YAML::Load(text))); }

std::string same(const std::string& text) { return dumped(YAML::Load(text)); }

TEST(RenamedKeys, MoveThePictureFromTheCameraToThePlant) {
  const YAML::Node out = withTodaysKeys(YAML::Load(
      "plant: {type: pendulum, dt: 0.1}\n"
      "camera: {size: 40, half_extent: 1.5, rod_half_width: 0.2, edge_softness: 0.3, delay: 2}\n"));
  EXPECT_EQ(out["plant"]["picture_size"].as<int>(), 40);
  EXPECT_EQ(out["plant"]["half_extent"].as<double>(), 1.5);
  EXPECT_EQ(out["plant"]["rod_half_width"].as<double>(), 0.2);
  EXPECT_EQ(out["plant"]["edge_softness"].as<double>(), 0.3);
  EXPECT_EQ(out["plant"]["type"].as<std::string>(), "pendulum");
  EXPECT_EQ(out["plant"]["dt"].as<double>(), 0.1);
  EXPECT_EQ(dumped(out["camera"]), same("{delay: 2}"));
}

TEST(RenamedKeys, MakeABlockWhereThereIsNone) {
  const YAML::Node out = withTodaysKeys(YAML::Load("camera: {half_extent: 1.5}"));
  EXPECT_EQ(dumped(out["plant"]), same("{half_extent: 1.5}"));
  EXPECT_EQ(out["camera"].size(), 0U);
}

TEST(RenamedKeys, GiveTheToleranceItsNameInAnyUnitAndTheUnitThatItHad) {
  const YAML::Node out =
      withTodaysKeys(YAML::Load("evaluation: {tolerance_deg: 5.0, settled_steps: 3}"));
  EXPECT_EQ(out["evaluation"]["tolerance"].as<double>(), 5.0);
  EXPECT_EQ(out["evaluation"]["error_unit"].as<std::string>(), "deg");
  EXPECT_EQ(out["evaluation"]["settled_steps"].as<int>(), 3);
  EXPECT_FALSE(out["evaluation"]["tolerance_deg"].IsDefined());
}

TEST(RenamedKeys, KeepAValueOfAnyKindToBeJudgedByItsBlock) {
  const YAML::Node out = withTodaysKeys(YAML::Load("camera: {size: many, half_extent: [1, 2]}"));
  EXPECT_EQ(out["plant"]["picture_size"].as<std::string>(), "many");
  EXPECT_EQ(out["plant"]["half_extent"].size(), 2U);
}

TEST(RenamedKeys, LeaveAKeyThatIsGivenByBothNames) {
  for (const char* text : {"camera: {size: 40}\nplant: {picture_size: 41}",
                           "camera: {half_extent: 1.2}\nplant: {half_extent: 1.3}",
                           "evaluation: {tolerance_deg: 5.0, tolerance: 6.0}"}) {
    EXPECT_EQ(today(text), same(text)) << text;
  }
}

TEST(RenamedKeys, ChangeNothingElse) {
  for (const char* text :
       {"{}", "", "7", "[1, 2]", "camera: 7", "camera: {noise_std: 0.1}", "plant: {size: 9}",
        "evaluation: {tolerance: 5.0, error_unit: m}", "camera: {size: 40}\nplant: 3",
        "plant: {type: moving_tile, tile_width: 7.0, picture_size: 40}\nmodel: {order: 2}"}) {
    EXPECT_EQ(today(text), same(text)) << text;
  }
}

TEST(RenamedKeys, LeaveTheirInputAlone) {
  const YAML::Node input = YAML::Load("camera: {size: 40}\nevaluation: {tolerance_deg: 5.0}");
  const std::string before = dumped(input);
  withTodaysKeys(input);
  EXPECT_EQ(dumped(input), before);
}

const char kOldPendulum[] =
    "version: 0.1.0 (abcdef0)\n"
    "evaluation: {tolerance_deg: 10.0}\n"
    "plant: {type: pendulum, gravity: 0.0, length: 1.0, mass: 1.0, friction: 1.0, max_torque: 6.0,"
    " dt: 0.2, start_std: 0.1, tile_width: 9.0, tile_softness: 9.0}\n"
    "camera: {size: 51, half_extent: 1.2, rod_half_width: 0.1, edge_softness: 0.2, delay: 0}\n";

TEST(RenamedKeys, DropWhatARunSavedThatIsNotOfItsPlant) {
  const YAML::Node pendulum = withTodaysKeys(YAML::Load(kOldPendulum));
  EXPECT_FALSE(pendulum["plant"]["tile_width"].IsDefined());
  EXPECT_FALSE(pendulum["plant"]["tile_softness"].IsDefined());
  EXPECT_EQ(pendulum["plant"]["half_extent"].as<double>(), 1.2);
  EXPECT_EQ(pendulum["plant"]["friction"].as<double>(), 1.0);
  EXPECT_EQ(pendulum["evaluation"]["tolerance"].as<double>(), 10.0);
  EXPECT_EQ(pendulum["version"].as<std::string>(), "0.1.0 (abcdef0)");

  std::string text = kOldPendulum;
  text.replace(text.find("pendulum"), 8, "moving_tile");
  const YAML::Node tile = withTodaysKeys(YAML::Load(text));
  EXPECT_EQ(tile["plant"]["tile_width"].as<double>(), 9.0);
  EXPECT_EQ(tile["plant"]["picture_size"].as<int>(), 51);
  for (const char* key : {"gravity", "length", "mass", "friction", "half_extent", "rod_half_width",
                          "edge_softness"}) {
    EXPECT_FALSE(tile["plant"][key].IsDefined()) << key;
  }
}

TEST(RenamedKeys, ComeBackTheSameFromAFileOfToday) {
  const char* text =
      "version: 0.2.0 (abcdef0)\nplant: {type: their_package/Rod, half_extent: 2.0}\n"
      "camera: {delay: 1}\nevaluation: {tolerance: 0.1, error_unit: m}";
  EXPECT_EQ(today(text), same(text));
  const std::string once = today(kOldPendulum);
  EXPECT_EQ(today(once), once);
}

TEST(RenamedKeys, KeepWhatAPersonWroteToBeRefused) {
  const YAML::Node out =
      withTodaysKeys(YAML::Load("plant: {type: pendulum, tile_width: 9.0}\ncamera: {size: 51}"));
  EXPECT_EQ(out["plant"]["tile_width"].as<double>(), 9.0);
}

/// All starts were of PCA where there were not more of them.
TEST(RenamedKeys, DropTheNumberOfStartsOfPcaThatARunSavedWhereAllWere) {
  const auto kept = [](const std::string& training) {
    return hasKey(withTodaysKeys(YAML::Load("version: 0.1.0 (abcdef0)\ntraining: " + training)),
                  "training", "pca_starts");
  };
  EXPECT_FALSE(kept("{num_starts: 3, pca_starts: 3}"));
  EXPECT_FALSE(kept("{num_starts: 1, pca_starts: 4}"));
  EXPECT_TRUE(kept("{num_starts: 3, pca_starts: 1}"));
  EXPECT_TRUE(kept("{num_starts: 3, pca_starts: many}"));
  EXPECT_TRUE(kept("{pca_starts: 1}"));
}

/// Old versions saved the look of the rod with the camera, whatever the plant: by default it says
/// nothing of a plant that is no rod.
TEST(RenamedKeys, DropTheLookOfARodThatARunSavedWithAPlantOfAnotherPackage) {
  const YAML::Node out = withTodaysKeys(YAML::Load(
      "version: 0.1.0 (abcdef0)\nplant: {type: their_package/Cart, dt: 0.2}\n"
      "camera: {size: 51, half_extent: 1.2, rod_half_width: 0.1, edge_softness: 0.2, delay: 0}\n"));
  EXPECT_EQ(out["plant"]["picture_size"].as<int>(), 51);
  for (const char* key : {"half_extent", "rod_half_width", "edge_softness"}) {
    EXPECT_FALSE(out["plant"][key].IsDefined()) << key;
    EXPECT_FALSE(out["camera"][key].IsDefined()) << key;
  }
}

/// Their plants could draw with it.
TEST(RenamedKeys, MoveTheLookThatARunSavedWithAPlantOfAnotherPackageWhereItIsNotTheDefault) {
  const YAML::Node out = withTodaysKeys(YAML::Load(
      "version: 0.1.0 (abcdef0)\nplant: {type: their_package/Cart, rod_half_width: 3.0}\n"
      "camera: {size: 51, half_extent: 2.0, rod_half_width: 0.1, edge_softness: 0.2}\n"));
  EXPECT_EQ(out["plant"]["half_extent"].as<double>(), 2.0);
  EXPECT_EQ(out["plant"]["rod_half_width"].as<double>(), 3.0);  // its own
  EXPECT_FALSE(out["plant"]["edge_softness"].IsDefined());
  EXPECT_EQ(out["camera"].size(), 0U);
}

/// Degrees are no pixels: the old tolerance counted nothing there.
TEST(RenamedKeys, DropTheToleranceInDegreesThatARunSavedWithAPlantOfLengths) {
  const YAML::Node out =
      withTodaysKeys(YAML::Load("version: 0.1.0 (abcdef0)\nplant: {type: moving_tile}\n"
                                "evaluation: {tolerance_deg: 10.0, settled_steps: 10}\n"));
  EXPECT_EQ(dumped(out["evaluation"]), same("{settled_steps: 10}"));
}

const char kOptionsThatAreGone[] =
    "training: {ensemble_size: 1, num_starts: 6, held_out: 0.0, consistency_weight: 0.0}\n"
    "mpc: {scale_distance: false, horizon: 15, saturation_width: 0.0, terminal_weight: 1.0,"
    " disagreement_bonus: 0.0}\n";

TEST(RenamedKeys, DropOptionsThatAreGoneWhereARunSavedThemSwitchedOff) {
  const YAML::Node out =
      withTodaysKeys(YAML::Load("version: 0.1.0 (abcdef0)\n" + std::string(kOptionsThatAreGone)));
  EXPECT_EQ(dumped(out["training"]), same("{num_starts: 6}"));
  EXPECT_EQ(dumped(out["mpc"]), same("{horizon: 15}"));
}

TEST(RenamedKeys, KeepOptionsThatAreGoneWhereTheyChangedARunOrAPersonWroteThem) {
  EXPECT_EQ(today(kOptionsThatAreGone), same(kOptionsThatAreGone));
  const char* used =
      "version: 0.1.0 (abcdef0)\ntraining: {ensemble_size: 3}\nmpc: {scale_distance: true}";
  EXPECT_EQ(today(used), same(used));
}

}  // namespace
}  // namespace ddm
