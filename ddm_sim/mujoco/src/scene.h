// The scene that is drawn: a model with the nuisances of colours, background, lights and camera.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "background.h"
#include "ddm_mujoco/render_options.h"

namespace ddm {

/// Physics never sees it: the model that it is made from stays as it is.
class Scene {
 public:
  /// @pre options have no problems
  /// @throws std::invalid_argument naming a picture of the background that cannot be read
  Scene(std::shared_ptr<const mjModel> model, const SceneOptions& options);
  Scene(const Scene&) = delete;  // appearance() points into this object
  Scene& operator=(const Scene&) = delete;

  /// The model as it looks, for drawing alone. Belongs to this object.
  mjModel& appearance() { return appearance_; }
  const mjModel& appearance() const { return appearance_; }

  /// Moves the camera of a drawn scene around the point that it looks at.
  void moveCamera(mjvGLCamera* camera) const;

  /// Moves the lights of a drawn scene, and changes their strength.
  void changeLights(mjvScene* drawn) const;

 private:
  Eigen::Vector3f middle() const;

  void drawCamera(const SceneOptions& options);
  void drawColours(const SceneOptions& options);
  void drawLights(const SceneOptions& options);

  std::shared_ptr<const mjModel> model_;
  mjModel appearance_;  ///< shares everything with model_ except for these colours and background
  std::vector<float> geom_rgba_;
  std::vector<float> site_rgba_;
  std::vector<float> mat_rgba_;
  std::vector<mjtByte> tex_rgb_;
  std::optional<Background> background_;
  Eigen::Matrix3f turn_;  ///< of the camera, in its own frame
  float nearer_ = 1.0F;   ///< its new distance to the point it looks at, in the old one
  struct LightChange {
    Eigen::Vector3f shift = Eigen::Vector3f::Zero();  ///< in distances to the middle of the scene
    float strength = 1.0F;
  };
  std::vector<LightChange> lights_;  ///< in the order of a drawn scene                 [mjMAXLIGHT]
};

}  // namespace ddm
