// Implements the renderer of MuJoCo models, without a screen.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mujoco/renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "ddm_sim/plant.h"
#include "egl_context.h"

namespace ddm {
namespace {

constexpr double kDegree = kPi / 180.0;
constexpr int kMaxDecor = 1000;  // drawn objects that are not geoms: sites, tendons, joints
constexpr int kNoCamera = -1;
constexpr int kNumShown = 3;  // MuJoCo draws the groups of geoms below this number
// Value by which MuJoCo marks a geom that has the colour of its material.
constexpr std::array<float, 4> kUnset = {0.5F, 0.5F, 0.5F, 1.0F};

bool hasColourOfMaterial(const mjModel& model, int geom) {
  return model.geom_matid[geom] >= 0 &&
         std::equal(kUnset.begin(), kUnset.end(), model.geom_rgba + 4 * geom);
}

/// Whether a geom is opaque enough to be visible and belongs to a body that a joint can move.
bool couldBeSeen(const mjModel& model, int geom) {
  const float* const rgba = hasColourOfMaterial(model, geom)
                                ? model.mat_rgba + 4 * model.geom_matid[geom]
                                : model.geom_rgba + 4 * geom;
  return rgba[3] > 0.0F && model.body_weldid[model.geom_bodyid[geom]] != 0;
}

/// Hidden group of geoms that has to be drawn because no other moving geom is visible; -1 if none.
int groupToShow(const mjModel& model) {
  std::set<int> groups;
  for (int i = 0; i < model.ngeom; ++i) {
    if (couldBeSeen(model, i)) groups.insert(model.geom_group[i]);
  }
  return groups.empty() || *groups.begin() < kNumShown ? -1 : *groups.begin();
}

/// @return index of the camera in the model, or kNoCamera if the options place a camera
/// @throws std::invalid_argument if the model has no such camera
int findCamera(const MujocoModel& model, const RenderOptions& options) {
  if (!options.position.empty()) return kNoCamera;
  if (!options.camera.empty()) return model.id(mjOBJ_CAMERA, options.camera, "plant/camera");
  if (model.get().ncam > 0) return 0;
  refuseModel("the model has no camera: give plant/camera_position and plant/camera_look_at");
}

/// A camera at `position`. The upper edge of its image points to +z, or to +y for a camera that
/// looks straight down.
mjvCamera placed(const std::vector<double>& position, const std::vector<double>& look_at) {
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FREE;
  mjtNum ahead[3];
  mju_sub3(ahead, look_at.data(), position.data());
  mju_copy3(camera.lookat, look_at.data());
  camera.distance = mju_normalize3(ahead);
  const bool vertical = ahead[0] == 0.0 && ahead[1] == 0.0;
  camera.azimuth = vertical ? 90.0 : std::atan2(ahead[1], ahead[0]) / kDegree;
  camera.elevation = std::asin(std::clamp(ahead[2], -1.0, 1.0)) / kDegree;
  return camera;
}

/// Averages the colours of an image that is `factor` times larger and upside down, as OpenGL stores
/// it.
RenderedImage averaged(const std::vector<std::uint8_t>& drawn, int width, int height, int factor) {
  RenderedImage rendered{width, height, 3, {}, {}};
  rendered.bytes.resize(rendered.numBytes());
  const std::size_t row_bytes = std::size_t{3} * static_cast<std::size_t>(width * factor);
  const int count = factor * factor;
  auto byte = rendered.bytes.begin();
  for (int row = 0; row < height; ++row) {
    const int lowest = (height - 1 - row) * factor;
    for (int column = 0; column < width; ++column) {
      int sum[3] = {0, 0, 0};
      for (int i = 0; i < factor; ++i) {
        const std::uint8_t* from = drawn.data() + static_cast<std::size_t>(lowest + i) * row_bytes +
                                   std::size_t{3} * static_cast<std::size_t>(column * factor);
        for (int k = 0; k < 3 * factor; ++k) sum[k % 3] += from[k];
      }
      for (const int channel : sum) {
        *byte++ = static_cast<std::uint8_t>((channel + count / 2) / count);
      }
    }
  }
  return rendered;
}

void requireNoError(const char* what) {
  const int error = mjr_getError();
  if (error == 0) return;
  throw std::runtime_error(textOf(what, " of a MuJoCo model failed, OpenGL error 0x", std::hex,
                                  error, error == 0x505 ? ": out of memory" : ""));
}

}  // namespace

bool isDrawnAndMoves(const mjModel& model, int geom) {
  const int group = model.geom_group[geom];
  return couldBeSeen(model, geom) && (group < kNumShown || group == groupToShow(model));
}

RenderedImage greyOf(const RenderedImage& rendered) {
  if (rendered.channels == 1) return rendered;
  RenderedImage grey = rendered;
  grey.channels = 1;
  grey.bytes.resize(grey.numBytes());
  const std::uint8_t* from = rendered.bytes.data();
  for (std::uint8_t& byte : grey.bytes) {
    byte = static_cast<std::uint8_t>((9798 * from[0] + 19235 * from[1] + 3735 * from[2] + 16384) >>
                                     15);
    from += 3;
  }
  return grey;
}

Renderer::Renderer(const std::shared_ptr<const MujocoModel>& model, const RenderOptions& options)
    : options_(options), model_(model), look_(model->get()) {
  look_.vis.global.offwidth = options_.width * options_.supersampling;
  look_.vis.global.offheight = options_.height * options_.supersampling;
  look_.vis.quality.offsamples = options_.for_people ? 4 : 0;
  const int index = findCamera(*model, options_);
  if (index == kNoCamera) {
    look_.vis.global.fovy = static_cast<float>(RenderOptions::kFieldOfView);
    camera_ = placed(options_.position, options_.look_at);
  } else {
    mjv_defaultCamera(&camera_);
    camera_.type = mjCAMERA_FIXED;
    camera_.fixedcamid = index;
  }
  mjv_defaultOption(&shown_);
  if (options_.for_people) {
    shown_.geomgroup[RenderOptions::kPeopleGroup] = 1;
    shown_.sitegroup[RenderOptions::kPeopleGroup] = 1;
  }
  const int group = groupToShow(look_);
  if (group >= 0) shown_.geomgroup[group] = 1;
  mjv_defaultScene(&drawn_);
  mjv_makeScene(&look_, &drawn_, look_.ngeom + kMaxDecor);
  drawn_.flags[mjRND_SHADOW] = drawn_.flags[mjRND_REFLECTION] = 1;
  mjr_defaultContext(&gpu_);
}

Renderer::~Renderer() {
  if (context_) {
    try {
      const EglContext::Current current(*context_);
      mjr_freeContext(&gpu_);
    } catch (const std::runtime_error&) {
      // The destructor of the context releases the rest.
    }
  }
  mjv_freeScene(&drawn_);
}

RenderedImage Renderer::draw(const mjData& data) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!context_) openContext();
  const EglContext::Current current(*context_);
  updateScene(data);
  const mjrRect all = {0, 0, gpu_.offWidth, gpu_.offHeight};
  mjr_render(all, &drawn_, &gpu_);
  pixels_.resize(std::size_t{3} * static_cast<std::size_t>(all.width) *
                 static_cast<std::size_t>(all.height));
  mjr_readPixels(pixels_.data(), nullptr, all, &gpu_);
  requireNoError("drawing");
  const RenderedImage colour =
      averaged(pixels_, options_.width, options_.height, options_.supersampling);
  return options_.colour ? colour : greyOf(colour);
}

CameraModel Renderer::camera(const mjData& data) {
  const std::lock_guard<std::mutex> lock(mutex_);
  updateScene(data);
  const mjvGLCamera camera = mjv_averageCamera(&drawn_.camera[0], &drawn_.camera[1]);
  const Eigen::Vector3f forward = Eigen::Map<const Eigen::Vector3f>(camera.forward);
  const Eigen::Vector3f down = -Eigen::Map<const Eigen::Vector3f>(camera.up);
  const int index = camera_.fixedcamid;
  const char* const name = index < 0 ? nullptr : mj_id2name(&look_, mjOBJ_CAMERA, index);
  CameraModel out;
  out.name = name == nullptr ? "camera" : name;
  out.width = options_.width;
  out.height = options_.height;
  out.fovy = kDegree * (index < 0 ? RenderOptions::kFieldOfView : look_.cam_fovy[index]);
  out.fixed = index < 0 || (look_.cam_mode[index] == mjCAMLIGHT_FIXED &&
                            look_.body_weldid[look_.cam_bodyid[index]] == 0);
  out.position = Eigen::Map<const Eigen::Vector3f>(camera.pos).cast<double>();
  out.rotation << down.cross(forward).cast<double>(), down.cast<double>(), forward.cast<double>();
  return out;
}

void Renderer::updateScene(const mjData& data) {
  // mjv_updateScene() only reads data, although its parameter is not const.
  mjv_updateScene(&look_, const_cast<mjData*>(&data), &shown_, nullptr, &camera_, mjCAT_ALL,
                  &drawn_);
}

void Renderer::openContext() {
  auto context = std::make_unique<EglContext>();
  const EglContext::Current current(*context);
  static std::mutex loading;  // MuJoCo stores the addresses of OpenGL functions in global variables
  const std::lock_guard<std::mutex> lock(loading);
  mjr_defaultContext(&gpu_);
  try {
    mjr_makeContext(&look_, &gpu_, mjFONTSCALE_50);
  } catch (const std::runtime_error& e) {
    throw std::runtime_error(textOf(
        "OpenGL cannot draw images of ", look_.vis.global.offwidth, " x ",
        look_.vis.global.offheight, " pixels, supersampling included, with ",
        look_.vis.quality.offsamples, " samples and a shadow map of ", look_.vis.quality.shadowsize,
        ": ", e.what(), "; free some memory, or make them smaller"));
  }
  mjr_setBuffer(mjFB_OFFSCREEN, &gpu_);
  if (gpu_.currentBuffer != mjFB_OFFSCREEN) {
    throw std::runtime_error("this OpenGL driver cannot draw without a screen");
  }
  requireNoError("making the textures and the image");
  context_ = std::move(context);
}

}  // namespace ddm
