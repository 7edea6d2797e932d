// Tests the renderer: positions in the image, equal bytes for equal states.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/renderer.h"

#include <ddm_common/image_codec.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_plant_plugin/image_message.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <boost/filesystem.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "model_folder.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using Bytes = std::vector<std::uint8_t>;

/// A model, and its data with the first joint at an angle [rad].
struct SceneModel {
  explicit SceneModel(double angle = 0.0) {
    data->qpos[0] = angle;
    mj_forward(&model->get(), data.get());
  }

  const std::shared_ptr<const MujocoModel> model = std::make_shared<MujocoModel>(
      DDM_MUJOCO_TEST_SCENE, [](const std::string& /*package*/) { return ""; });
  const std::shared_ptr<mjData> data{mj_makeData(&model->get()), mj_deleteData};
};

RenderOptions colourful(const std::string& camera = "front") {
  RenderOptions options;
  options.camera = camera;
  options.colour = true;
  return options;
}

RenderedImage drawn(const SceneModel& scene, const RenderOptions& options) {
  return Renderer(scene.model, options).draw(*scene.data);
}

/// Mean position of the pixels with a colour: column and row from the upper left corner [pixels].
struct Spot {
  int count = 0;
  double column = 0.0;
  double row = 0.0;
};

Spot spotOf(const RenderedImage& rendered,
            const std::function<bool(int r, int g, int b)>& belongs) {
  Spot spot;
  const std::uint8_t* at = rendered.bytes.data();
  for (int row = 0; row < rendered.height; ++row) {
    for (int column = 0; column < rendered.width; ++column, at += rendered.channels) {
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

double meanDifference(const RenderedImage& a, const RenderedImage& b) {
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
      Renderer renderer(scene.model, options);
      const Spot ball = spotOf(renderer.draw(*scene.data), isRed);
      ASSERT_GT(ball.count, 50) << name;

      const CameraModel camera = renderer.camera(*scene.data);
      EXPECT_EQ(camera.name, name);
      EXPECT_TRUE(camera.fixed);
      const int geom = mj_name2id(&scene.model->get(), mjOBJ_GEOM, "ball");
      const Eigen::Vector3d world(scene.data->geom_xpos + 3 * geom);
      const Eigen::Vector3d seen = camera.rotation.transpose() * (world - camera.position);
      ASSERT_GT(seen.z(), 0.0);
      const double f = camera.focalLength();
      EXPECT_NEAR(ball.column, 80.0 + f * seen.x() / seen.z(), 1.5) << name << " " << angle;
      EXPECT_NEAR(ball.row, 60.0 + f * seen.y() / seen.z(), 1.5) << name << " " << angle;
    }
  }
}

TEST(Renderer, TakesTheFirstCameraOfTheModelOrPlacesOneThatTheModelDoesNotHave) {
  const SceneModel scene(0.3);
  EXPECT_EQ(drawn(scene, colourful("")).bytes, drawn(scene, colourful("front")).bytes);
  RenderOptions placed = colourful("");
  placed.position = {0.0, -4.0, 1.0};
  placed.look_at = {0.0, 0.0, 1.0};
  EXPECT_LT(meanDifference(drawn(scene, placed), drawn(scene, colourful("front"))), 0.1);

  placed.position = {0.2, 0.1, 5.0};
  placed.look_at = {0.2, 0.1, 0.0};
  const CameraModel camera = Renderer(scene.model, placed).camera(*scene.data);
  Eigen::Matrix3d down_with_y_up;
  down_with_y_up << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  EXPECT_TRUE(camera.rotation.isApprox(down_with_y_up, 1e-6)) << camera.rotation;
  EXPECT_TRUE(camera.position.isApprox(Eigen::Vector3d(0.2, 0.1, 5.0), 1e-6));
  EXPECT_TRUE(camera.fixed);
}

TEST(Renderer, GivesTheSameBytesOnAllThreads) {
  const SceneModel scene(0.4);
  Renderer shared(scene.model, colourful());
  const Bytes expected = shared.draw(*scene.data).bytes;
  std::vector<Bytes> results(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < results.size(); i += 2) {
    threads.emplace_back([&, i] {
      const SceneModel own_scene(0.4);
      Renderer own(own_scene.model, colourful());
      for (int k = 0; k < 5; ++k) {
        results[i] = own.draw(*own_scene.data).bytes;
        results[i + 1] = shared.draw(*scene.data).bytes;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Bytes& result : results) EXPECT_EQ(result, expected);
}

TEST(Renderer, DrawsOnTheCallersThread) {
  drawn(SceneModel(0.4), colourful());
  std::vector<std::string> drawing;  // Mesa's threads for drawing
  for (const auto& task : boost::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::ifstream((task.path() / "comm").string()) >> name;
    if (name.rfind("llvmpipe", 0) == 0) drawing.push_back(name);
  }
  EXPECT_EQ(drawing, std::vector<std::string>());
}

TEST(Renderer, TurnsEveryColourIntoTheGreyOfAReader) {
  RenderedImage colours;
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
  const auto drawnIn = [&scene](int width, int supersampling) {
    RenderOptions options = colourful();
    options.width = width;
    options.height = width / 2;
    options.supersampling = supersampling;
    return drawn(scene, options);
  };
  const RenderedImage small = drawnIn(20, 3), large = drawnIn(60, 1);
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

TEST(Renderer, RefusesAModelWithoutACameraNamingTheKeysThatPlaceOne) {
  const auto bare =
      testing::ModelFolder().loadText("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>");
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&bare] { Renderer(bare, RenderOptions()); },
      {"no camera", "plant/camera_position", "plant/camera_look_at"}));
}

}  // namespace
}  // namespace ddm
