// Tests of the renderer: what is seen where, that equal states give equal bytes, what is refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/renderer.h"

#include <ddm_common/image_codec.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_plant_plugin/picture_message.h>
#include <gtest/gtest.h>

#include <boost/filesystem.hpp>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "scene_model.h"

namespace ddm {
namespace {

using testing::colourful;
using testing::SceneModel;
using testing::throwsNaming;
using Bytes = std::vector<std::uint8_t>;

Picture drawn(const SceneModel& scene, const RenderOptions& options,
              const SceneOptions& nuisances = {}) {
  return Renderer(scene.model, options, nuisances).draw(*scene.data);
}

/// Middle of the pixels of a colour: column and row from the upper left corner [pixels].
struct Spot {
  int count = 0;
  double column = 0.0;
  double row = 0.0;
};

Spot spotOf(const Picture& picture, const std::function<bool(int r, int g, int b)>& belongs) {
  Spot spot;
  const std::uint8_t* at = picture.bytes.data();
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column, at += picture.channels) {
      if (!belongs(at[0], at[1], at[2])) continue;
      ++spot.count;
      spot.column += column + 0.5;
      spot.row += row + 0.5;
    }
  }
  spot.column /= spot.count;
  spot.row /= spot.count;
  return spot;
}

bool isRed(int red, int green, int blue) { return red > 60 && red > 3 * green && red > 3 * blue; }
bool isGreen(int red, int green, int blue) {
  return green > 60 && green > 3 * red && green > 3 * blue;
}

double meanDifference(const Picture& a, const Picture& b) {
  EXPECT_EQ(a.bytes.size(), b.bytes.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < a.bytes.size(); ++i) sum += std::abs(a.bytes[i] - b.bytes[i]);
  return sum / static_cast<double>(a.bytes.size());
}

TEST(Renderer, ShowsThingsWhereACameraWithItsModelSeesThem) {
  for (const char* name : {"front", "oblique"}) {
    for (const double angle : {0.0, -1.0}) {
      const SceneModel scene(angle);
      RenderOptions options = colourful(name);
      options.width = 160;
      options.height = 120;
      Renderer renderer(scene.model, options, SceneOptions());
      const Spot ball = spotOf(renderer.draw(*scene.data), isRed);
      ASSERT_GT(ball.count, 50) << name;

      const CameraModel camera = renderer.camera(*scene.data);
      EXPECT_EQ(camera.name, name);
      EXPECT_TRUE(camera.fixed);
      const int geom = mj_name2id(scene.model.get(), mjOBJ_GEOM, "ball");
      const Eigen::Vector3d world(scene.data->geom_xpos + 3 * geom);
      const Eigen::Vector3d seen = camera.rotation.transpose() * (world - camera.position);
      ASSERT_GT(seen.z(), 0.0);
      const double f = camera.focalLength();
      EXPECT_NEAR(ball.column, 80.0 + f * seen.x() / seen.z(), 1.5) << name << " " << angle;
      EXPECT_NEAR(ball.row, 60.0 + f * seen.y() / seen.z(), 1.5) << name << " " << angle;
    }
  }
}

TEST(Renderer, PlacesACameraThatTheModelDoesNotHave) {
  const SceneModel scene(0.3);
  RenderOptions placed = colourful("");
  placed.position = {0.0, -4.0, 1.0};
  placed.look_at = {0.0, 0.0, 1.0};
  placed.field_of_view = 40.0;
  EXPECT_LT(meanDifference(drawn(scene, placed), drawn(scene, colourful("front"))), 0.1);

  placed.position = {0.2, 0.1, 5.0};
  placed.look_at = {0.2, 0.1, 0.0};
  const CameraModel camera = Renderer(scene.model, placed, SceneOptions()).camera(*scene.data);
  Eigen::Matrix3d down_with_y_up;
  down_with_y_up << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  EXPECT_TRUE(camera.rotation.isApprox(down_with_y_up, 1e-6)) << camera.rotation;
  EXPECT_TRUE(camera.position.isApprox(Eigen::Vector3d(0.2, 0.1, 5.0), 1e-6));
  EXPECT_TRUE(camera.fixed);
}

TEST(Renderer, TakesTheFirstCameraOfTheModelWhereNoneIsNamed) {
  const SceneModel scene;
  EXPECT_EQ(drawn(scene, colourful("")).bytes, drawn(scene, colourful("front")).bytes);
}

TEST(Renderer, GivesTheSameBytesForTheSameStateInTurnsAndTwins) {
  SceneModel scene(0.4);
  RenderOptions options;
  options.samples = 4;
  Renderer renderer(scene.model, options, SceneOptions());
  const Bytes first = renderer.draw(*scene.data).bytes;
  EXPECT_EQ(first.size(), std::size_t{51 * 51});
  scene.turn(1.0);
  EXPECT_NE(renderer.draw(*scene.data).bytes, first);
  scene.turn(0.4);
  EXPECT_EQ(renderer.draw(*scene.data).bytes, first);
  EXPECT_EQ(drawn(scene, options).bytes, first);
}

TEST(Renderer, GivesTheSameBytesOnAllThreads) {
  const SceneModel scene(0.4);
  const RenderOptions options = colourful();
  Renderer shared(scene.model, options, SceneOptions());
  const Bytes expected = shared.draw(*scene.data).bytes;
  std::vector<Bytes> of_shared(4);
  std::vector<Bytes> of_own(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < of_own.size(); ++i) {
    threads.emplace_back([&, i] {
      const SceneModel own_scene(0.4);
      Renderer own(own_scene.model, options, SceneOptions());
      for (int k = 0; k < 5; ++k) {
        of_own[i] = own.draw(*own_scene.data).bytes;
        of_shared[i] = shared.draw(*scene.data).bytes;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < of_own.size(); ++i) {
    EXPECT_EQ(of_own[i], expected) << i;
    EXPECT_EQ(of_shared[i], expected) << i;
  }
}

TEST(Renderer, DrawsOnTheCallersThread) {
  drawn(SceneModel(0.4), colourful());
  std::vector<std::string> drawing;  // threads of Mesa that draw
  for (const auto& task : boost::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::ifstream((task.path() / "comm").string()) >> name;
    if (name.rfind("llvmpipe", 0) == 0) drawing.push_back(name);
  }
  EXPECT_EQ(drawing, std::vector<std::string>());
}

TEST(Renderer, TurnsEveryColourIntoTheGreyOfAReader) {
  Picture colours;
  colours.width = colours.height = 256;
  colours.channels = 3;
  for (int i = 0; i < 256 * 256; ++i) {
    for (const int byte : {i % 256, i / 256, (37 * i) % 256}) {
      colours.bytes.push_back(static_cast<std::uint8_t>(byte));
    }
  }
  EXPECT_EQ(greyOf(colours).bytes, decodeImage(imageMessage(colours, ros::Time(1.0)), 256));
}

TEST(Renderer, AveragesWhatItDrawsLarger) {
  const SceneModel scene(0.4);
  RenderOptions options = colourful();
  options.width = 20;
  options.height = 10;
  options.supersampling = 3;
  const Picture small = drawn(scene, options);
  options.width = 60;
  options.height = 30;
  options.supersampling = 1;
  const Picture large = drawn(scene, options);
  for (int row = 0; row < 10; ++row) {
    for (int byte = 0; byte < 60; ++byte) {
      int sum = 0;
      for (int i = 0; i < 9; ++i) {
        const int from_row = 3 * row + i / 3;
        const int from_column = 3 * (byte / 3) + i % 3;
        sum += large.bytes[static_cast<std::size_t>(180 * from_row + 3 * from_column + byte % 3)];
      }
      ASSERT_EQ(small.bytes[static_cast<std::size_t>(60 * row + byte)], (sum + 4) / 9);
    }
  }
}

TEST(Renderer, ShowsPeopleWhatALearnerDoesNotSee) {
  const SceneModel scene;
  RenderOptions options = colourful();
  EXPECT_EQ(spotOf(drawn(scene, options), isGreen).count, 0);
  options.for_people = true;
  EXPECT_GT(spotOf(drawn(scene, options), isGreen).count, 5);
}

TEST(Renderer, RefusesACameraThatIsNotThereNamingThoseThatAre) {
  const SceneModel scene;
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&scene] { Renderer(scene.model, colourful("frnt"), SceneOptions()); },
      {"plant/camera", "frnt", "front", "oblique", "riding"}));
  const std::string without_camera = "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>";
  mjVFS files;
  mj_defaultVFS(&files);
  ASSERT_EQ(mj_makeEmptyFileVFS(&files, "bare.xml", static_cast<int>(without_camera.size())), 0);
  std::copy(without_camera.begin(), without_camera.end(), static_cast<char*>(files.filedata[0]));
  char problem[500] = "";
  const std::shared_ptr<mjModel> bare(mj_loadXML("bare.xml", &files, problem, 500), mj_deleteModel);
  mj_deleteVFS(&files);
  ASSERT_TRUE(bare) << problem;
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&bare] { Renderer(bare, RenderOptions(), SceneOptions()); },
      {"no camera", "plant/camera_position", "plant/camera_look_at"}));
}

TEST(Renderer, ReportsAllProblemsOfItsOptions) {
  const SceneModel scene;
  RenderOptions options;
  options.position = {0.0, 1.0};
  options.field_of_view = std::numeric_limits<double>::quiet_NaN();
  options.samples = 2;
  options.supersampling = 9;
  SceneOptions nuisances;
  nuisances.camera_shift = -0.1;
  nuisances.colour_shift = 2.0;
  nuisances.seed = -1;
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { Renderer(scene.model, options, nuisances); },
      {"plant/camera_position", "plant/camera_look_at", "plant/camera_field_of_view",
       "plant/samples", "plant/supersampling", "plant/camera_shift", "plant/colour_shift",
       "plant/scene_seed"}));
  EXPECT_TRUE(RenderOptions().problems("plant").empty());
  EXPECT_TRUE(SceneOptions().problems("plant").empty());
}

}  // namespace
}  // namespace ddm
