// The paper's moving tile: a square that is pushed about in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

constexpr double kTileWidth = 9.0;     ///< w, width and height of the tile [pixels]
constexpr double kTileSoftness = 9.0;  ///< s, grey falls from 1 to 0 over so much [pixels]

/// YAML block `plant:` of the type `moving_tile`.
struct MovingTileOptions : PlantOptions {
  MovingTileOptions() { type = "moving_tile"; }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// Draws y, the image of the moving tile: a white square on black, a little out of focus.
///
///   grey(i, j) = c(i - y) c(j - x),   c(d) = |[d + 1/2 - s/2, d + 1/2 + s/2] n [-w/2, w/2]| / s
///
/// with row i and column j counted from 0 at the upper left, so that the picture spans [0, size] in
/// both directions: each pixel shows the mean over a window of s x s pixels around its centre. Grey
/// falls from 1 to 0 over s pixels at the edges: the tile is as blurred as the rod of the pendulum,
/// whose edges are as soft as it is wide. Sharper edges are too sharp for 50 principal components.
/// Nothing is sampled, and the image is a continuous function of the position. What lies outside the
/// picture is cut off.
/// Deviation: the paper does not describe its renderer; this one is ours.
/// @param size    width and height of the image, >= 1 [pixels]
/// @param centre  (x, y), x to the right and y downwards [pixels], finite       [2 x 1]
Picture drawTile(int size, const Eigen::Vector2d& centre);

/// Tile with the state (x, y), its centre in the picture [pixels], and two inputs.
///
///   (x, y)+ = reflect((x, y) + u),   reflect into [w/2, size - w/2] in each direction
///
/// x runs to the right and y downwards from the upper left corner of the picture, which spans
/// [0, size]. The "torques" u are increments of position [pixels], one
/// to the right and one downwards; there are no rates. A tile that would leave the picture bounces
/// off the border with all of its way, as often as it takes, and so stays wholly inside. step()
/// reports the increment before the reflection.
///
/// It starts around the middle of the picture. Its goal is (3/4 size, 1/4 size), or the nearest
/// place that it can reach; its error is the distance to it [pixels]. A start state may lie
/// outside, where the picture shows a part of the tile or none; the next step brings it back.
/// Deviation: the paper gives neither the size of the tile nor the range of the increments, nor
/// what happens at the border; these are ours.
class MovingTile : public Plant {
 public:
  /// @throws std::invalid_argument with all problems of the options
  explicit MovingTile(const MovingTileOptions& options);

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override;
  Picture draw(const Eigen::VectorXd& state) const override;
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override { return state; }

  int size_;  ///< of the picture [pixels]
  double
      highest_;  ///< size - w / 2, greatest coordinate of the centre; the least is w / 2 [pixels]
};

}  // namespace ddm
