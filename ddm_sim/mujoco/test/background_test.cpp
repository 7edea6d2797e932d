// Tests of the background of a scene: sky, floor and walls show it, what moves does not.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>
#include <vector>

#include "ddm_mujoco/renderer.h"
#include "scene_model.h"

namespace ddm {
namespace {

using testing::SceneModel;
using testing::TempFolder;
using testing::throwsNaming;
using Colour = std::array<int, 3>;

constexpr int kSize = 51;

SceneOptions backgroundOf(double share, const std::vector<std::string>& pictures = {}) {
  SceneOptions scene;
  scene.background = share;
  scene.background_pictures = pictures;
  return scene;
}

Picture seen(const SceneModel& model, const SceneOptions& scene) {
  RenderOptions options = testing::colourful();
  options.shadows = options.reflections = false;
  return Renderer(model.model, options, scene).draw(*model.data);
}

/// @param row, column  from above and from the left
Colour at(const Picture& picture, int row, int column) {
  const std::uint8_t* byte = picture.bytes.data() + 3 * (row * picture.width + column);
  return {byte[0], byte[1], byte[2]};
}

/// A picture of one colour.
std::string paint(const TempFolder& folder, const std::string& name, const Colour& rgb) {
  const cv::Mat picture(20, 30, CV_8UC3, cv::Scalar(rgb[2], rgb[1], rgb[0]));
  cv::imwrite(folder.file(name), picture);
  return folder.file(name);
}

// Where the scene of the tests, with its rod to the right, has sky, ball and floor.
const std::array<int, 2> kSky = {3, 10}, kBall = {25, 38}, kFloor = {45, 25};

TEST(Background, IsShownBySkyAndFloorAndNotByWhatMoves) {
  const SceneModel model;
  const Picture plain = seen(model, SceneOptions());
  const Picture changed = seen(model, backgroundOf(1.0));
  EXPECT_NE(at(changed, kSky[0], kSky[1]), at(plain, kSky[0], kSky[1]));
  EXPECT_NE(at(changed, kFloor[0], kFloor[1]), at(plain, kFloor[0], kFloor[1]));
  EXPECT_EQ(at(changed, kBall[0], kBall[1]), at(plain, kBall[0], kBall[1]));
}

TEST(Background, IsAPatternOfManyColours) {
  const Picture changed = seen(SceneModel(), backgroundOf(1.0));
  std::set<Colour> sky;
  for (int column = 0; column < kSize; ++column) sky.insert(at(changed, 3, column));
  EXPECT_GT(sky.size(), 5U);
}

TEST(Background, IsAPictureOfTheUsers) {
  const TempFolder folder;
  const SceneModel model;
  const std::string green = paint(folder, "green.png", {10, 200, 30});
  const Picture all = seen(model, backgroundOf(1.0, {green}));
  EXPECT_EQ(at(all, kSky[0], kSky[1]), (Colour{10, 200, 30}));  // no light falls on the sky
  const Colour floor = at(all, kFloor[0], kFloor[1]);
  EXPECT_GT(floor[1], 4 * floor[0]);
  EXPECT_GT(floor[1], 4 * floor[2]);

  const Colour sky = at(seen(model, SceneOptions()), kSky[0], kSky[1]);
  const Colour half = at(seen(model, backgroundOf(0.5, {green})), kSky[0], kSky[1]);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(half[k], 0.5 * (all.bytes[k] + sky[k]), 2.0);
}

TEST(Background, IsOneOfSeveralPicturesByTheSeed) {
  const TempFolder folder;
  const SceneModel model;
  const Colour green{10, 200, 30}, blue{20, 40, 250};
  SceneOptions scene =
      backgroundOf(1.0, {paint(folder, "a.png", green), paint(folder, "b.png", blue)});
  std::set<Colour> skies;
  for (scene.seed = 0; scene.seed < 8; ++scene.seed) {
    skies.insert(at(seen(model, scene), kSky[0], kSky[1]));
  }
  EXPECT_EQ(skies, (std::set<Colour>{green, blue}));
}

TEST(Background, IsBehindAModelWithoutSkyAndTextures) {
  const TempFolder folder;
  const SceneModel model;
  model.model->tex_type[mj_name2id(model.model.get(), mjOBJ_TEXTURE, "sky")] = mjTEXTURE_CUBE;
  model.model->mat_texid[mj_name2id(model.model.get(), mjOBJ_MATERIAL, "floor")] = -1;
  EXPECT_EQ(at(seen(model, SceneOptions()), kSky[0], kSky[1]), (Colour{0, 0, 0}));
  const Picture green = seen(model, backgroundOf(1.0, {paint(folder, "green.png", {10, 200, 30})}));
  EXPECT_EQ(at(green, kSky[0], kSky[1]), (Colour{10, 200, 30}));
  const Colour floor = at(green, kFloor[0], kFloor[1]);
  EXPECT_GT(floor[1], 4 * floor[0]);
}

TEST(Background, IsOnBoxesThatStandStill) {
  const TempFolder folder;
  const SceneModel model;
  const int floor = mj_name2id(model.model.get(), mjOBJ_GEOM, "floor");
  model.model->geom_type[floor] = mjGEOM_BOX;
  model.model->geom_matid[floor] = -1;
  const std::string picture = paint(folder, "green.png", {10, 200, 30});
  const Colour green = at(seen(model, backgroundOf(1.0, {picture})), kFloor[0], kFloor[1]);
  EXPECT_GT(green[1], 4 * green[0]);
  model.model->geom_bodyid[floor] = mj_name2id(model.model.get(), mjOBJ_BODY, "rod");
  const Colour grey = at(seen(model, backgroundOf(1.0, {picture})), kFloor[0], kFloor[1]);
  EXPECT_EQ(grey[0], grey[1]);
}

TEST(Background, IsNotMirrored) {
  const TempFolder folder;
  cv::Mat both(20, 20, CV_8UC3, cv::Scalar(0, 0, 250));  // red on the left, blue on the right
  both.colRange(10, 20).setTo(cv::Scalar(250, 0, 0));
  cv::imwrite(folder.file("both.png"), both);
  const Picture sky = seen(SceneModel(), backgroundOf(1.0, {folder.file("both.png")}));
  EXPECT_EQ(at(sky, 3, 5), (Colour{250, 0, 0}));
  EXPECT_EQ(at(sky, 3, 45), (Colour{0, 0, 250}));
}

TEST(Background, LeavesTheTexturesOfTheModelThatMoves) {
  const SceneModel model;
  const mjModel& m = *model.model;
  const int num_textures = m.ntex;
  const std::vector<mjtByte> before(m.tex_rgb, m.tex_rgb + m.ntexdata);
  seen(model, backgroundOf(1.0));
  EXPECT_EQ(m.ntex, num_textures);
  EXPECT_EQ(std::vector<mjtByte>(m.tex_rgb, m.tex_rgb + m.ntexdata), before);
}

TEST(Background, NamesAPictureThatCannotBeRead) {
  const TempFolder folder;
  const SceneModel model;
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { seen(model, backgroundOf(1.0, {folder.file("none.png")})); },
      {"plant/background_pictures", "none.png"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { seen(model, backgroundOf(0.0, {"any.png"})); }, {"plant/background "}));
}

}  // namespace
}  // namespace ddm
