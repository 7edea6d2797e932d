// A static background: what sky, floor and walls of a scene show instead of their own colours.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <random>
#include <vector>

#include "ddm_mujoco/render_options.h"

namespace ddm {

/// What MuJoCo takes for a geom that leaves its colour to its material.
constexpr std::array<float, 4> kUnset = {0.5F, 0.5F, 0.5F, 1.0F};

/// Sky, floor and walls are the skybox, which is made where a model has none, and all planes and
/// boxes that stand still. Everything else keeps its look, and what lights and shadows do to floor and walls
/// stays. With a share s of SceneOptions::background
///
///   colour = (1 - s) own + s background
class Background {
 public:
  /// @param rng         draws the pattern, or one of the pictures
  /// @param appearance  in, out: points into this object from now on
  /// @throws std::invalid_argument naming a picture that cannot be read
  Background(const SceneOptions& options, std::mt19937_64 rng, mjModel* appearance);
  Background(const Background&) = delete;  // a model points into it
  Background& operator=(const Background&) = delete;

 private:
  using Bytes = std::vector<mjtByte>;

  template <class Apply>
  void forEachArray(mjModel* model, const Apply& apply);
  void paintSky();
  void paintGeom(int geom, double extent);
  void addMaterial(int like);
  int addTexture(int type, int width, const Bytes& rgb);
  Bytes texelsOf(int texture) const;
  Bytes mixed(const Bytes& own, int width, bool mirrored) const;

  double share_;
  Bytes tile_;  ///< of the background, kTile x kTile, repeated without seams if it is a pattern
  std::vector<int> tex_type_, tex_height_, tex_width_, tex_adr_;
  Bytes tex_rgb_;
  std::vector<int> mat_texid_;
  std::vector<mjtByte> mat_texuniform_;
  std::vector<float> mat_texrepeat_, mat_emission_, mat_specular_, mat_shininess_, mat_reflectance_,
      mat_rgba_;
  std::vector<int> geom_matid_;
  std::vector<float> geom_rgba_;
};

}  // namespace ddm
