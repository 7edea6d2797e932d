// Draws the scene of a MuJoCo model without a screen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/picture.h>
#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace ddm {

class EglContext;
class Scene;

/// How a scene is drawn. The camera is one of the model (`camera`), or stands where the model has
/// none (`position`).
struct RenderOptions {
  std::string camera;            ///< name in the model; empty: its first one
  std::vector<double> position;  ///< of a camera that the model does not have [m]    [0 or 3]
  std::vector<double> look_at;   ///< the point in the middle of its image [m]        [0 or 3]
  int width = 51;                ///< [pixels]
  int height = 51;               ///< [pixels]
  bool colour = false;           ///< else grey
  int samples = 0;               ///< 0, or 4: edges are averaged over four points of a pixel
  int supersampling = 1;         ///< the image is drawn so many times larger, then averaged
  bool for_people = false;       ///< also show the geoms and sites of group kPeopleGroup

  // Disturbances of the scene: shares of the largest change. 0: none, 0.1: easy.
  double camera_shift = 0.0;  ///< the camera goes around the point it looks at, and turns
  double colour_shift = 0.0;  ///< of each thing, texture and sky

  static constexpr double kFieldOfView = 45.0;  ///< vertical angle of a camera at `position` [deg]
  static constexpr int kPeopleGroup = 4;
};

/// One camera's images of one model. The same state gives the same bytes, each time, on each
/// thread and in each process, with one version of Mesa and one of MuJoCo.
///
/// A grey value is that of the colour image's bytes, as image_codec turns colour into grey:
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
  /// @param options  valid, see MujocoOptions::problems()
  /// @throws std::invalid_argument if the model has no such camera, naming those that it has
  Renderer(const std::shared_ptr<const mjModel>& model, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// What the camera sees; the image has no cover. Any thread may call it, one draws at a time.
  /// @param data  positions of this state: after mj_forward(), or mj_kinematics() and mj_camlight()
  /// @throws std::runtime_error naming what fails: no EGL, an image that the driver cannot draw
  Picture draw(const mjData& data);

  /// Where the camera is in this state; draws nothing.
  CameraModel camera(const mjData& data);

 private:
  void updateScene(const mjData& data);
  void openContext();
  void makeGpuContext();

  RenderOptions options_;
  std::unique_ptr<Scene> scene_;
  mjvCamera camera_;
  mjvOption shown_;
  mjvScene drawn_;
  mjrContext gpu_;
  std::unique_ptr<EglContext> context_;  ///< with gpu_ in it; none: nothing has been drawn yet
  std::vector<std::uint8_t> pixels_;     ///< as drawn, kept for the next time
  std::mutex mutex_;
};

/// What draws in this process, GL_RENDERER and GL_VERSION. Pixels differ from one driver to
/// another.
/// @throws std::runtime_error naming the step of EGL that fails
std::string openGlRenderer();

/// Whether a geom belongs to a body that a joint moves, and is drawn: not transparent, and in one
/// of the groups that a Renderer shows.
bool isDrawnAndMoves(const mjModel& model, int geom);

/// Grey of a colour image, byte by byte as above; a grey one as it is.
Picture greyOf(const Picture& picture);

}  // namespace ddm
