// Draws the scene of a MuJoCo model without a screen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/picture.h>
#include <mujoco/mujoco.h>

#include <memory>
#include <string>

#include "ddm_mujoco/render_options.h"

namespace ddm {

/// One camera's pictures of one model. The same state gives the same bytes, each time, on each
/// thread and in each process, with one version of Mesa and one of MuJoCo.
///
/// A grey value is that of the colour picture's bytes, as image_codec turns colour into grey:
///
///   grey = (9798 red + 19235 green + 3735 blue + 16384) div 32768        (0.299, 0.587, 0.114)
///
/// Software draws (Mesa's llvmpipe) unless the environment variable LIBGL_ALWAYS_SOFTWARE is 0.
///
/// Geoms of the groups 0 to 2 are drawn, as in MuJoCo's viewer. If nothing that moves is among
/// them, those of the first other group with something that moves are drawn, too: a file that has
/// collision shapes alone is not invisible.
///
/// Nothing is drawn, and no context made, before the first draw().
class Renderer {
 public:
  /// @param model  outlives this object's use of it: shared
  /// @throws std::invalid_argument with all problems of the options, or if the model has no such
  ///         camera, naming those that it has
  Renderer(std::shared_ptr<const mjModel> model, const RenderOptions& options,
           const SceneOptions& scene);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// What the camera sees; its cover is not known. Any thread may call it, one draws at a time.
  /// @param data  positions of this state: after mj_forward(), or mj_kinematics() and mj_camlight()
  /// @throws std::runtime_error naming what fails: no EGL, a picture that the driver cannot draw
  Picture draw(const mjData& data);

  /// Where the camera is in this state; draws nothing.
  CameraModel camera(const mjData& data) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// What draws in this process, GL_RENDERER and GL_VERSION. Pixels differ from one driver to
/// another.
/// @throws std::runtime_error naming the step of EGL that fails
std::string openGlRenderer();

/// Whether a geom belongs to a body that a joint moves, and is drawn: not transparent, and in one
/// of the groups that a Renderer shows.
bool isDrawnAndMoves(const mjModel& model, int geom);

/// Grey of a colour picture, byte by byte as above; a grey one as it is.
Picture greyOf(const Picture& picture);

}  // namespace ddm
