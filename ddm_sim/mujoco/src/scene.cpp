// Implements the scene that a renderer draws: a model with disturbances of its colours and camera.
// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include <ddm_common/random_stream.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "ddm_sim/angles.h"

namespace ddm {
namespace {

constexpr double kQuarterTurn = 0.5 * kPi;
constexpr double kNearest = 0.5;  // relative change of the camera's distance at a share of 1 [-]

/// Each disturbance has its own random stream, so that one disturbance does not change another.
enum Part : std::uint32_t { kCameraPart, kColourPart };

/// Random numbers, uniform in [-share, share].
class Shift {
 public:
  Shift(Part part, double share)
      : rng_(randomStream({0, part, false}, StreamRole::kScene)), uniform_(-share, share) {}

  double operator()() { return uniform_(rng_); }
  float asFloat() { return static_cast<float>(uniform_(rng_)); }

 private:
  std::mt19937_64 rng_;
  std::uniform_real_distribution<double> uniform_;
};

/// Copies an array into `owner` and returns the copy's address.
template <class Value>
Value* copied(const Value* values, int count, std::vector<Value>* owner) {
  owner->assign(values, values + count);
  return owner->data();
}

/// Adds random numbers to the red, green and blue of `count` objects. Opacity stays unchanged.
void shiftColours(Shift* shift, int count, float* rgba) {
  for (int i = 0; i < count; ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      float& value = rgba[4 * i + channel];
      value = std::clamp(value + shift->asFloat(), 0.0F, 1.0F);
    }
  }
}

using Vector = Eigen::Map<Eigen::Vector3f>;

}  // namespace

Scene::Scene(std::shared_ptr<const mjModel> model, const RenderOptions& options)
    : model_(std::move(model)), appearance_(*model_), turn_(Eigen::Matrix3f::Identity()) {
  if (options.camera_shift > 0.0) drawCamera(options.camera_shift);
  if (options.colour_shift > 0.0) drawColours(options.colour_shift);
}

void Scene::drawCamera(double share) {
  Shift shift(kCameraPart, share);
  const auto turn = [&shift](const Eigen::Vector3f& axis) {
    return Eigen::AngleAxisf(static_cast<float>(kQuarterTurn * shift()), axis);
  };
  turn_ = turn(Eigen::Vector3f::UnitY());
  turn_ = turn_ * turn(Eigen::Vector3f::UnitX());
  turn_ = turn_ * turn(Eigen::Vector3f::UnitZ());
  nearer_ = static_cast<float>(1.0 + kNearest * shift());
}

void Scene::drawColours(double share) {
  Shift shift(kColourPart, share);
  const mjModel& m = *model_;
  appearance_.geom_rgba = copied(m.geom_rgba, 4 * m.ngeom, &geom_rgba_);
  appearance_.site_rgba = copied(m.site_rgba, 4 * m.nsite, &site_rgba_);
  appearance_.mat_rgba = copied(m.mat_rgba, 4 * m.nmat, &mat_rgba_);
  appearance_.tex_rgb = copied(m.tex_rgb, m.ntexdata, &tex_rgb_);
  shiftColours(&shift, m.ngeom, appearance_.geom_rgba);
  // A geom whose colour differs from kUnset no longer shows its material. Such geoms keep kUnset.
  for (int i = 0; i < m.ngeom; ++i) {
    const bool unset = std::equal(kUnset.begin(), kUnset.end(), m.geom_rgba + 4 * i);
    if (m.geom_matid[i] >= 0 && unset) {
      std::copy_n(m.geom_rgba + 4 * i, 4, appearance_.geom_rgba + 4 * i);
    }
  }
  shiftColours(&shift, m.nsite, appearance_.site_rgba);
  shiftColours(&shift, m.nmat, appearance_.mat_rgba);
  for (int i = 0; i < m.ntex; ++i) {
    const std::array<double, 3> change = {shift(), shift(), shift()};
    mjtByte* const texel = appearance_.tex_rgb + m.tex_adr[i];
    for (int k = 0; k < 3 * m.tex_width[i] * m.tex_height[i]; ++k) {
      const double value = texel[k] + 255.0 * change[static_cast<std::size_t>(k % 3)];
      texel[k] = static_cast<mjtByte>(std::clamp(value, 0.0, 255.0) + 0.5);
    }
  }
}

void Scene::moveCamera(mjvGLCamera* camera) const {
  Vector position(camera->pos);
  Vector forward(camera->forward);
  Vector up(camera->up);
  Eigen::Matrix3f axes;  // axes of the camera in the world: right, up, backwards
  axes << forward.cross(up), up, -forward;
  const Eigen::Vector3f middle =
      Eigen::Map<const Eigen::Vector3d>(model_->stat.center).cast<float>();
  const float distance = std::max((middle - position).dot(forward), camera->frustum_near);
  const Eigen::Vector3f target = position + distance * forward;
  const Eigen::Matrix3f turned = axes * turn_;
  up = turned.col(1);
  forward = -turned.col(2);
  position = target - nearer_ * distance * forward;
}

}  // namespace ddm
