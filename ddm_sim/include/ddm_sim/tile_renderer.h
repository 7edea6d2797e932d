// Camera picture of a square tile with soft edges.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_sim/picture.h"

namespace ddm {

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
class TileRenderer {
 public:
  /// @param size        width and height of the image [pixels]
  /// @param tile_width  w, width and height of the tile [pixels]
  /// @param softness    s, width of its edges [pixels]
  /// @throws std::invalid_argument if size or softness is not >= 1, or tile_width not > 0 and
  /// finite
  TileRenderer(int size, double tile_width, double softness);

  /// @param centre  (x, y), x to the right and y downwards [pixels], finite         [2 x 1]
  Picture render(const Eigen::Vector2d& centre) const;

 private:
  int size_;
  double tile_width_;
  double softness_;
};

}  // namespace ddm
