// Tests of what a scene's nuisances change, and what they leave alone.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "ddm_mujoco/renderer.h"
#include "scene_model.h"

namespace ddm {
namespace {

using testing::colourful;
using testing::SceneModel;
using Bytes = std::vector<std::uint8_t>;
using Key = double SceneOptions::*;

const std::vector<Key> kKeys = {&SceneOptions::camera_shift, &SceneOptions::colour_shift};

SceneOptions shifted(Key key, double share, int seed = 0) {
  SceneOptions scene;
  scene.*key = share;
  scene.seed = seed;
  return scene;
}

Bytes drawnWith(const SceneModel& model, const SceneOptions& nuisances) {
  return Renderer(model.model, colourful(), nuisances).draw(*model.data).bytes;
}

CameraModel cameraOf(const SceneModel& model, const SceneOptions& nuisances) {
  return Renderer(model.model, colourful(), nuisances).camera(*model.data);
}

TEST(SceneNuisances, ChangeThePictureAndAreFixedByTheirSeed) {
  const SceneModel model(0.4);
  const Bytes plain = drawnWith(model, SceneOptions());
  EXPECT_EQ(drawnWith(model, shifted(&SceneOptions::camera_shift, 0.0, 7)), plain);
  for (const Key key : kKeys) {
    const Bytes once = drawnWith(model, shifted(key, 0.1));
    EXPECT_NE(once, plain);
    EXPECT_EQ(drawnWith(model, shifted(key, 0.1)), once);
    EXPECT_NE(drawnWith(model, shifted(key, 0.1, 1)), once);
    EXPECT_NE(drawnWith(model, shifted(key, 0.2)), once);
  }
}

TEST(SceneNuisances, LeaveTheModelThatMovesAsItIs) {
  const SceneModel model(0.4);
  const int colours = 4 * model.model->ngeom;
  const std::vector<float> before(model.model->geom_rgba, model.model->geom_rgba + colours);
  SceneOptions all = shifted(&SceneOptions::camera_shift, 0.3);
  all.colour_shift = 0.3;
  drawnWith(model, all);
  EXPECT_EQ(std::vector<float>(model.model->geom_rgba, model.model->geom_rgba + colours), before);
  EXPECT_EQ(model.model->cam_pos[1], -4.0);
}

TEST(SceneNuisances, MoveTheCameraAroundThePointThatItLooksAt) {
  const SceneModel model;
  const CameraModel plain = cameraOf(model, SceneOptions());
  const Eigen::Vector3d ahead = plain.rotation.col(2);
  const Eigen::Vector3d centre(model.model->stat.center);
  const double distance = (centre - plain.position).dot(ahead);
  const Eigen::Vector3d target = plain.position + distance * ahead;
  double largest = 0.0;
  for (int seed = 0; seed < 20; ++seed) {
    const CameraModel moved = cameraOf(model, shifted(&SceneOptions::camera_shift, 0.1, seed));
    EXPECT_TRUE((moved.rotation.transpose() * moved.rotation).isIdentity(1e-5));
    const Eigen::Vector3d to_target = target - moved.position;
    EXPECT_LT(to_target.normalized().cross(moved.rotation.col(2)).norm(), 1e-5);
    EXPECT_NEAR(to_target.norm() / distance, 1.0, 0.05 + 1e-5);
    largest = std::max(largest, std::abs(to_target.norm() / distance - 1.0));
    // Two turns of at most 9 degrees each move the view, a third one rolls it.
    EXPECT_GT(moved.rotation.col(2).dot(ahead), std::cos(0.1 * M_PI * std::sqrt(0.5)));
    EXPECT_EQ(moved.fovy, plain.fovy);
  }
  EXPECT_GT(largest, 0.03);
}

TEST(SceneNuisances, OfOneKindLeaveTheOthersAlone) {
  const SceneModel model;
  const CameraModel plain = cameraOf(model, SceneOptions());
  const CameraModel moved = cameraOf(model, shifted(&SceneOptions::camera_shift, 0.1));
  SceneOptions all = shifted(&SceneOptions::camera_shift, 0.1);
  all.colour_shift = 0.1;
  EXPECT_EQ(cameraOf(model, all).position, moved.position);
  EXPECT_EQ(cameraOf(model, shifted(&SceneOptions::colour_shift, 0.1)).position, plain.position);
}

}  // namespace
}  // namespace ddm
