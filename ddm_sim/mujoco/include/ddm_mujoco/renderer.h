// Class Renderer: draws the scene of a MuJoCo model without a screen.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/rendered_image.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {

class EglContext;

/// How a scene is drawn. The camera is either one of the model (`camera`), or an additional one at
/// a given position (`position`, `look_at`).
struct RenderOptions {
  std::string camera;            ///< name of a camera in the model; empty: its first camera
  std::vector<double> position;  ///< position of an additional camera [m]           [0 or 3]
  std::vector<double> look_at;   ///< point in the middle of that camera's image [m] [0 or 3]
  int width = 51;                ///< [pixels]
  int height = 51;               ///< [pixels]
  bool colour = false;           ///< true: RGB, false: grey
  int supersampling = 1;         ///< factor by which the image is drawn larger before averaging
  /// Also draws the geoms and sites of group kPeopleGroup, and averages edges over four points of
  /// each pixel.
  bool for_people = false;

  /// Vertical field of view of a camera at `position` [deg]
  static constexpr double kFieldOfView = 45.0;
  static constexpr int kPeopleGroup = 4;
};

/// Draws the images of one camera in one model. Equal states give equal bytes in each call, thread
/// and process, as long as the versions of Mesa and MuJoCo are the same.
///
/// A grey image is computed from the bytes of the colour image, in the same way as image_codec
/// computes grey from colour:
///
///   grey = (9798 red + 19235 green + 3735 blue + 16384) div 32768        (0.299, 0.587, 0.114)
///
/// The CPU draws (Mesa's llvmpipe) unless the environment variable LIBGL_ALWAYS_SOFTWARE is 0.
///
/// The renderer draws the geoms of the groups 0 to 2, like MuJoCo's viewer. If none of these geoms
/// moves, the renderer also draws the first other group with a moving geom, so that a file with
/// only collision shapes is not invisible.
///
/// The first call of draw() creates the OpenGL context.
class Renderer {
 public:
  /// @param options  valid options, see MujocoOptions::problems()
  /// @throws std::invalid_argument with the names of the model's cameras if the model has no camera
  ///         with the name in the options
  Renderer(const std::shared_ptr<const MujocoModel>& model, const RenderOptions& options);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws the rendered image of the camera; the cover (RenderedImage) stays empty. Several threads may
  /// call this function; one thread draws at a time.
  /// @param data  positions of the state, after mj_forward(), or after mj_kinematics() and
  ///         mj_camlight()
  /// @throws std::runtime_error naming the step that fails: EGL is missing, or the driver cannot
  ///         draw an image of this size
  RenderedImage draw(const mjData& data);

  /// Position and lens of the camera in this state. Draws nothing.
  CameraModel camera(const mjData& data);

 private:
  void updateScene(const mjData& data);
  void openContext();

  RenderOptions options_;
  std::shared_ptr<const MujocoModel> model_;
  /// The model with the image size and lens of this renderer. Its arrays are those of model_.
  mjModel look_;
  mjvCamera camera_;
  mjvOption shown_;
  mjvScene drawn_;
  mjrContext gpu_;
  /// OpenGL context that holds gpu_; null before the first image.
  std::unique_ptr<EglContext> context_;
  /// Bytes of the last drawn image, kept to avoid a new allocation.
  std::vector<std::uint8_t> pixels_;
  std::mutex mutex_;
};

/// GL_RENDERER and GL_VERSION of the driver that draws in this process: "llvmpipe (LLVM 15.0.6, 256
/// bits), 4.5 (...) Mesa 22.3.6". Pixels differ between drivers.
/// @throws std::runtime_error naming the step of EGL that fails
std::string openGlRenderer();

/// Whether a geom belongs to a body that a joint moves and is drawn: it is not transparent, and its
/// group is one that a Renderer shows.
bool isDrawnAndMoves(const mjModel& model, int geom);

/// Grey image of a colour image by the formula above. Returns a grey image unchanged.
RenderedImage greyOf(const RenderedImage& rendered);

}  // namespace ddm
