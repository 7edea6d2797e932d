// The paper's moving tile: a square that the inputs move across the image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

constexpr double kTileWidth = 9.0;  ///< w, width and height of the tile [pixels]
/// s, width over which grey falls from 1 to 0 at an edge [pixels]
constexpr double kTileSoftness = 9.0;

/// YAML block `plant:` of the type `moving_tile`.
struct MovingTileOptions : PlantOptions {
  MovingTileOptions() { type = "moving_tile"; }

  std::vector<std::string> problems() const;
};

/// Draws the moving tile: a white square with blurred edges on black.
///
///   grey(i, j) = c(i - y) c(j - x),   c(d) = |[d + 1/2 - s/2, d + 1/2 + s/2] n [-w/2, w/2]| / s
///
/// Row i and column j count from 0 at the upper left corner, so the image spans [0, size] in both
/// directions. `n` is the intersection of two intervals and |.| is its length: each pixel shows the
/// mean of a sharp square over a window of s x s pixels around the centre of the pixel. Grey
/// therefore falls from 1 to 0 over s pixels at the edges. The rod of the pendulum is blurred in
/// the same proportion: its edges are as soft as the rod is wide. With sharper edges, 50 principal
/// components do not represent the images well enough. The mean is computed in closed form, so the
/// image is a continuous function of the position. Parts of the tile outside the image are cut off.
/// Deviation: the paper does not describe its renderer; this one is our choice.
/// @param size    width and height of the image, >= 1 [pixels]
/// @param centre  (x, y), x to the right and y downwards [pixels], finite                   [2 x 1]
RenderedImage drawTile(int size, const Eigen::Vector2d& centre);

/// A tile with the state (x, y), the position of its centre in the image [pixels], and two inputs.
///
///   (x, y)+ = reflect((x, y) + u),   reflect into [w/2, size - w/2] in each direction
///
/// x runs to the right and y runs downwards from the upper left corner of the image, which spans
/// [0, size]. The two components of the torque u are increments of the position [pixels], one to
/// the right and one downwards. The state has no rates. A tile that would leave the image is
/// reflected at the border, repeatedly if the increment is long, so the tile always stays
/// completely inside. step() returns the increment before the reflection.
///
/// The initial state lies around the middle of the image. The goal is (3/4 size, 1/4 size), or the
/// nearest position that the tile can reach. The error is the distance to the goal [pixels].
/// setState() accepts positions outside the image; the image then shows a part of the tile or no
/// tile, and the next step moves the tile back inside.
/// Deviation: the paper states neither the size of the tile, nor the range of the increments, nor
/// the behaviour at the border; these are our choices.
class MovingTile : public Plant {
 public:
  /// @throws std::invalid_argument with all problems of the options
  explicit MovingTile(const MovingTileOptions& options);

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override;
  RenderedImage draw(const Eigen::VectorXd& state) const override;
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override { return state; }

  int size_;  ///< width and height of the image [pixels]
  double
      highest_;  ///< size - w / 2, largest coordinate of the centre; the smallest is w / 2 [pixels]
};

}  // namespace ddm
