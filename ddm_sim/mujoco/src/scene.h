// Class Scene: a model with disturbances of its colours and camera, for drawing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "ddm_mujoco/renderer.h"

namespace ddm {

/// Value by which MuJoCo marks a geom that has the colour of its material.
constexpr std::array<float, 4> kUnset = {0.5F, 0.5F, 0.5F, 1.0F};

/// A copy of a model's appearance with disturbances. The original model, which the physics uses,
/// stays unchanged.
class Scene {
 public:
  Scene(std::shared_ptr<const mjModel> model, const RenderOptions& options);
  Scene(const Scene&) = delete;  // appearance() points into this object
  Scene& operator=(const Scene&) = delete;

  /// The model with changed colours, to be used for drawing only. This object owns it.
  mjModel& appearance() { return appearance_; }

  /// Moves the camera of a drawn scene around the point that it looks at.
  void moveCamera(mjvGLCamera* camera) const;

 private:
  void drawCamera(double share);
  void drawColours(double share);

  std::shared_ptr<const mjModel> model_;
  /// Uses the arrays of model_ except for the following colours.
  mjModel appearance_;
  std::vector<float> geom_rgba_;
  std::vector<float> site_rgba_;
  std::vector<float> mat_rgba_;
  std::vector<mjtByte> tex_rgb_;
  Eigen::Matrix3f turn_;  ///< rotation of the camera, in its own frame
  /// New distance to the point that the camera looks at, divided by the old one.
  float nearer_ = 1.0F;
};

}  // namespace ddm
