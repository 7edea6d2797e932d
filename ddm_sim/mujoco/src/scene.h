// The scene that is drawn: a model with disturbances of its colours and camera.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "ddm_mujoco/renderer.h"

namespace ddm {

/// MuJoCo's sign for a geom that leaves its colour to its material.
constexpr std::array<float, 4> kUnset = {0.5F, 0.5F, 0.5F, 1.0F};

/// Physics never sees it: the model that it is made from stays as it is.
class Scene {
 public:
  Scene(std::shared_ptr<const mjModel> model, const RenderOptions& options);
  Scene(const Scene&) = delete;  // appearance() points into this object
  Scene& operator=(const Scene&) = delete;

  /// The model as it looks, for drawing alone. Belongs to this object.
  mjModel& appearance() { return appearance_; }

  /// Moves the camera of a drawn scene around the point that it looks at.
  void moveCamera(mjvGLCamera* camera) const;

 private:
  void drawCamera(double share);
  void drawColours(double share);

  std::shared_ptr<const mjModel> model_;
  mjModel appearance_;  ///< shares everything with model_ except for these colours
  std::vector<float> geom_rgba_;
  std::vector<float> site_rgba_;
  std::vector<float> mat_rgba_;
  std::vector<mjtByte> tex_rgb_;
  Eigen::Matrix3f turn_;  ///< of the camera, in its own frame
  float nearer_ = 1.0F;   ///< its new distance to the point it looks at, in the old one
};

}  // namespace ddm
