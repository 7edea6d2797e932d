// A static background: what sky, floor and walls of a scene show instead of their own colours.
// SPDX-License-Identifier: BSD-3-Clause
#include "background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

using Bytes = std::vector<mjtByte>;

constexpr int kTile = 256;  // width and height of a background [texels]
constexpr int kNumDiscs = 40;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

/// The square picture, `width` texels wide. MuJoCo shows skies as seen from outside, mirrored.
Bytes resized(const Bytes& tile, int width, bool mirrored) {
  const cv::Mat picture(kTile, kTile, CV_8UC3, const_cast<mjtByte*>(tile.data()));
  Bytes out(at(3 * width * width));
  cv::Mat target(width, width, CV_8UC3, out.data());
  cv::resize(picture, target, target.size(), 0.0, 0.0,
             width < kTile ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (mirrored) cv::flip(target, target, /*flipCode=*/1);
  return out;
}

/// Discs, sharp and soft, each in front of the last. One that leaves at an edge enters at the
/// opposite one.
Bytes drawPattern(std::mt19937_64* rng) {
  const auto uniform = [rng](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(*rng);
  };
  std::vector<double> colours(at(3 * kTile * kTile));
  for (int disc = 0; disc < kNumDiscs; ++disc) {
    const double x = uniform(0.0, 1.0);
    const double y = uniform(0.0, 1.0);
    const double radius = disc == 0 ? 1.0 : uniform(0.05, 0.2);  // the first one covers everything
    const double softness = uniform(0.0, 1.0) < 0.5 ? 1.0 / kTile : uniform(0.02, 0.1);
    const std::array<double, 3> colour = {uniform(0, 255), uniform(0, 255), uniform(0, 255)};
    double* texel = colours.data();
    for (int i = 0; i < kTile; ++i) {
      const double up = std::remainder((i + 0.5) / kTile - y, 1.0);
      for (int j = 0; j < kTile; ++j, texel += 3) {
        const double along = std::remainder((j + 0.5) / kTile - x, 1.0);
        const double outside = std::hypot(along, up) - radius;
        const double cover = std::clamp(0.5 - outside / softness, 0.0, 1.0);
        for (int k = 0; k < 3; ++k) texel[k] += cover * (colour[at(k)] - texel[k]);
      }
    }
  }
  return Bytes(colours.begin(), colours.end());
}

/// @throws std::invalid_argument if there is no such picture
Bytes readPicture(const std::string& path) {
  cv::Mat picture = cv::imread(path, cv::IMREAD_COLOR);
  if (picture.empty()) {
    throw std::invalid_argument(
        "plant/background_pictures must be picture files (PNG, JPEG), got " + path +
        ", which cannot be read as one");
  }
  cv::resize(picture, picture, cv::Size(kTile, kTile), 0.0, 0.0, cv::INTER_AREA);
  cv::cvtColor(picture, picture, cv::COLOR_BGR2RGB);
  return Bytes(picture.data, picture.data + picture.total() * picture.elemSize());
}

Bytes drawTile(const std::vector<std::string>& pictures, std::mt19937_64* rng) {
  if (pictures.empty()) return drawPattern(rng);
  return readPicture(pictures[(*rng)() % pictures.size()]);
}

}  // namespace

/// @param apply  takes an array of the model, ours, and the number of values
template <class Apply>
void Background::forEachArray(mjModel* model, const Apply& apply) {
  apply(&model->tex_type, &tex_type_, model->ntex);
  apply(&model->tex_height, &tex_height_, model->ntex);
  apply(&model->tex_width, &tex_width_, model->ntex);
  apply(&model->tex_adr, &tex_adr_, model->ntex);
  apply(&model->tex_rgb, &tex_rgb_, model->ntexdata);
  apply(&model->mat_texid, &mat_texid_, model->nmat);
  apply(&model->mat_texuniform, &mat_texuniform_, model->nmat);
  apply(&model->mat_texrepeat, &mat_texrepeat_, 2 * model->nmat);
  apply(&model->mat_emission, &mat_emission_, model->nmat);
  apply(&model->mat_specular, &mat_specular_, model->nmat);
  apply(&model->mat_shininess, &mat_shininess_, model->nmat);
  apply(&model->mat_reflectance, &mat_reflectance_, model->nmat);
  apply(&model->mat_rgba, &mat_rgba_, 4 * model->nmat);
  apply(&model->geom_matid, &geom_matid_, model->ngeom);
  apply(&model->geom_rgba, &geom_rgba_, 4 * model->ngeom);
}

Background::Background(const SceneOptions& options, std::mt19937_64 rng, mjModel* appearance)
    : share_(options.background), tile_(drawTile(options.background_pictures, &rng)) {
  forEachArray(appearance, [](auto** theirs, auto* ours, int count) {
    ours->assign(*theirs, *theirs + count);
  });
  paintSky();
  for (int i = 0; i < appearance->ngeom; ++i) {
    const int body = appearance->geom_bodyid[i];
    const int type = appearance->geom_type[i];
    const bool stands_still = appearance->body_weldid[body] == 0;
    if (stands_still && (type == mjGEOM_PLANE || type == mjGEOM_BOX)) {
      paintGeom(i, appearance->stat.extent);
    }
  }
  forEachArray(appearance, [](auto** theirs, auto* ours, int) { *theirs = ours->data(); });
  appearance->ntex = static_cast<int>(tex_type_.size());
  appearance->ntexdata = static_cast<int>(tex_rgb_.size());
  appearance->nmat = static_cast<int>(mat_texid_.size());
}

void Background::paintSky() {
  const auto sky = std::find(tex_type_.begin(), tex_type_.end(), mjTEXTURE_SKYBOX);
  if (sky == tex_type_.end()) {
    const Bytes black(at(3 * kTile * kTile));
    addTexture(mjTEXTURE_SKYBOX, kTile, mixed(black, kTile, /*mirrored=*/true));
    return;
  }
  const auto texture = static_cast<int>(sky - tex_type_.begin());
  const Bytes rgb = mixed(texelsOf(texture), tex_width_[at(texture)], /*mirrored=*/true);
  std::copy(rgb.begin(), rgb.end(), tex_rgb_.begin() + tex_adr_[at(texture)]);
}

/// Gives plane or box a material and a texture of its own: others may share those that it has.
/// @param extent  of the scene [m]: how large the background is on one without a texture
void Background::paintGeom(int geom, double extent) {
  const int own = geom_matid_[at(geom)];
  const auto colour_of_geom = geom_rgba_.begin() + 4 * geom;
  const bool unset = std::equal(kUnset.begin(), kUnset.end(), colour_of_geom);
  const auto colour = own >= 0 && unset ? mat_rgba_.begin() + 4 * own : colour_of_geom;
  const std::array<float, 4> rgba = {colour[0], colour[1], colour[2], colour[3]};
  std::copy(kUnset.begin(), kUnset.end(), colour_of_geom);

  addMaterial(own);
  const std::size_t material = mat_texid_.size() - 1;
  geom_matid_[at(geom)] = static_cast<int>(material);
  const int texture = mat_texid_[material];
  const int width = texture >= 0 ? tex_width_[at(texture)] : kTile;
  const int type = texture >= 0 ? tex_type_[at(texture)] : static_cast<int>(mjTEXTURE_2D);
  Bytes rgb = texture >= 0 ? texelsOf(texture) : Bytes(at(3 * kTile * kTile), 255);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgb[i] = static_cast<mjtByte>(std::clamp(rgba[i % 3], 0.0F, 1.0F) * static_cast<float>(rgb[i]));
  }
  if (texture < 0) {
    mat_texuniform_[material] = 1;
    std::fill_n(mat_texrepeat_.begin() + 2 * static_cast<std::ptrdiff_t>(material), 2,
                static_cast<float>(1.0 / extent));
  }
  mat_texid_[material] = addTexture(type, width, mixed(rgb, width, /*mirrored=*/false));
  std::copy_n(std::array<float, 4>{1.0F, 1.0F, 1.0F, rgba[3]}.begin(), 4, mat_rgba_.end() - 4);
}

/// @param like  a material, or -1 for MuJoCo's default
void Background::addMaterial(int like) {
  const auto add = [like](auto* values, auto unset, int count = 1) {
    for (int i = 0; i < count; ++i) {
      values->push_back(like >= 0 ? (*values)[at(count * like + i)] : unset);
    }
  };
  add(&mat_texid_, -1);
  add(&mat_texuniform_, mjtByte{0});
  add(&mat_texrepeat_, 1.0F, 2);
  add(&mat_emission_, 0.0F);
  add(&mat_specular_, 0.5F);
  add(&mat_shininess_, 0.5F);
  add(&mat_reflectance_, 0.0F);
  add(&mat_rgba_, 1.0F, 4);
}

/// @return its number
int Background::addTexture(int type, int width, const Bytes& rgb) {
  tex_type_.push_back(type);
  tex_width_.push_back(width);
  tex_height_.push_back(static_cast<int>(rgb.size()) / (3 * width));
  tex_adr_.push_back(static_cast<int>(tex_rgb_.size()));
  tex_rgb_.insert(tex_rgb_.end(), rgb.begin(), rgb.end());
  return static_cast<int>(tex_type_.size()) - 1;
}

Background::Bytes Background::texelsOf(int texture) const {
  const auto first = tex_rgb_.begin() + tex_adr_[at(texture)];
  return Bytes(first, first + 3 * tex_width_[at(texture)] * tex_height_[at(texture)]);
}

/// A texture with the background; a cube has it on each face, one below the other.
Background::Bytes Background::mixed(const Bytes& own, int width, bool mirrored) const {
  const Bytes face = resized(tile_, width, mirrored);
  Bytes out(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    out[i] = static_cast<mjtByte>((1.0 - share_) * own[i] + share_ * face[i % face.size()] + 0.5);
  }
  return out;
}

}  // namespace ddm
