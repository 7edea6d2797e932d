// The paper's moving tile: a square that is pushed about in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// YAML block `plant:` of the type `moving_tile`.
struct MovingTileOptions : PlantOptions {
  double tile_width = 9.0;     ///< width and height of the tile [pixels]
  double tile_softness = 9.0;  ///< grey falls from 1 to 0 over so much [pixels]

  MovingTileOptions() { type = "moving_tile"; }

  template <class Visitor>
  void visit(Visitor& visitor) {
    PlantOptions::visit(visitor);
    visitor("tile_width", tile_width);
    visitor("tile_softness", tile_softness);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// Draws y, the image of the moving tile: a white square on black, a little out of focus.
///
///   grey(i, j) = c(i - y) c(j - x),   c(d) = |[d + 1/2 - s/2, d + 1/2 + s/2] n [-w/2, w/2]| / s
///
/// with row i and column j counted from 0 at the upper left, so that the picture spans [0, size] in
/// both directions: each pixel shows the mean over a window of s x s pixels around its centre. Grey
/// falls from 1 to 0 over s pixels at the edges; s = 1 is the exact area of the pixel under the
/// tile. Nothing is sampled, and the image is a continuous function of the position. What lies
/// outside the picture is cut off.
/// Deviation: the paper does not describe its renderer; this one is ours.
/// @param size      width and height of the image, >= 1 [pixels]
/// @param width     w, width and height of the tile, > 0 [pixels]
/// @param softness  s, width of its edges, >= 1 [pixels]
/// @param centre    (x, y), x to the right and y downwards [pixels], finite       [2 x 1]
Picture drawTile(int size, double width, double softness, const Eigen::Vector2d& centre);

/// Tile with the state (x, y), its centre in the picture [pixels], and two inputs.
///
///   (x, y)+ = reflect((x, y) + u),   reflect into [w/2, size - w/2] in each direction
///
/// x runs to the right and y downwards from the upper left corner of the picture, which spans
/// [0, size]; w is the width of the tile. The "torques" u are increments of position [pixels], one
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

  MovingTileOptions options_;
  double lowest_;   ///< w / 2, least coordinate of the centre [pixels]
  double highest_;  ///< size - w / 2, its greatest [pixels]
};

}  // namespace ddm
