// The scene that is drawn: draws its nuisances, and applies them.
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
constexpr double kNearest = 0.5;  // change of distance at a share of 1

/// What is drawn apart, so that switching one nuisance on does not change another.
enum Part : std::uint32_t { kCameraPart, kColourPart };

/// Uniform in [-share, share].
class Shift {
 public:
  Shift(const SceneOptions& options, Part part, double share)
      : rng_(randomStream({static_cast<std::uint64_t>(options.seed), part, false},
                          StreamRole::kScene)),
        uniform_(-share, share) {}

  double operator()() { return uniform_(rng_); }
  float asFloat() { return static_cast<float>(uniform_(rng_)); }

 private:
  std::mt19937_64 rng_;
  std::uniform_real_distribution<double> uniform_;
};

template <class Value>
std::vector<Value> copied(const Value* values, int count) {
  return std::vector<Value>(values, values + count);
}

/// Shifts the three colours, not the opacity, of `count` things.
void shiftColours(Shift* shift, int count, std::vector<float>* rgba) {
  for (int i = 0; i < count; ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      float& value = (*rgba)[static_cast<std::size_t>(4 * i + channel)];
      value = std::clamp(value + shift->asFloat(), 0.0F, 1.0F);
    }
  }
}

using Vector = Eigen::Map<Eigen::Vector3f>;

}  // namespace

Scene::Scene(std::shared_ptr<const mjModel> model, const SceneOptions& options)
    : model_(std::move(model)), appearance_(*model_), turn_(Eigen::Matrix3f::Identity()) {
  if (options.camera_shift > 0.0) drawCamera(options);
  if (options.colour_shift > 0.0) drawColours(options);
}

void Scene::drawCamera(const SceneOptions& options) {
  Shift shift(options, kCameraPart, options.camera_shift);
  const auto turn = [&shift](const Eigen::Vector3f& axis) {
    return Eigen::AngleAxisf(static_cast<float>(kQuarterTurn * shift()), axis);
  };
  turn_ = turn(Eigen::Vector3f::UnitY());
  turn_ = turn_ * turn(Eigen::Vector3f::UnitX());
  turn_ = turn_ * turn(Eigen::Vector3f::UnitZ());
  nearer_ = static_cast<float>(1.0 + kNearest * shift());
}

void Scene::drawColours(const SceneOptions& options) {
  Shift shift(options, kColourPart, options.colour_shift);
  geom_rgba_ = copied(model_->geom_rgba, 4 * model_->ngeom);
  site_rgba_ = copied(model_->site_rgba, 4 * model_->nsite);
  mat_rgba_ = copied(model_->mat_rgba, 4 * model_->nmat);
  tex_rgb_ = copied(model_->tex_rgb, model_->ntexdata);
  const std::vector<float> own = geom_rgba_;
  shiftColours(&shift, model_->ngeom, &geom_rgba_);
  // A geom shows its own colour in the place of its material's if it is not the default one.
  for (int i = 0; i < model_->ngeom; ++i) {
    const auto first = own.begin() + 4 * i;
    if (model_->geom_matid[i] >= 0 && std::equal(kUnset.begin(), kUnset.end(), first)) {
      std::copy(first, first + 4, geom_rgba_.begin() + 4 * i);
    }
  }
  shiftColours(&shift, model_->nsite, &site_rgba_);
  shiftColours(&shift, model_->nmat, &mat_rgba_);
  for (int i = 0; i < model_->ntex; ++i) {
    const std::array<double, 3> change = {shift(), shift(), shift()};
    mjtByte* texel = tex_rgb_.data() + model_->tex_adr[i];
    for (int k = 0; k < 3 * model_->tex_width[i] * model_->tex_height[i]; ++k) {
      const double value = texel[k] + 255.0 * change[static_cast<std::size_t>(k % 3)];
      texel[k] = static_cast<mjtByte>(std::clamp(value, 0.0, 255.0) + 0.5);
    }
  }
  appearance_.geom_rgba = geom_rgba_.data();
  appearance_.site_rgba = site_rgba_.data();
  appearance_.mat_rgba = mat_rgba_.data();
  appearance_.tex_rgb = tex_rgb_.data();
}

void Scene::moveCamera(mjvGLCamera* camera) const {
  Vector position(camera->pos);
  Vector forward(camera->forward);
  Vector up(camera->up);
  Eigen::Matrix3f axes;  // of the camera in the world: right, up, backwards
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
