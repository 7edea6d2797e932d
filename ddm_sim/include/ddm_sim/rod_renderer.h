// Renderer for rods with soft edges: the link of a pendulum, the links of an arm.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ddm_sim/rendered_image.h"

namespace ddm {

/// Half the width of the scene [m]. The image shows [-kHalfExtent, kHalfExtent] in both directions,
/// and the first rod begins at its centre.
constexpr double kHalfExtent = 1.2;

/// Appearance of rods. These keys belong to the block `plant` of each plant that consists of rods.
struct RodLook {
  double rod_half_width = 0.1;  ///< half the width of a rod [m]
  double edge_softness = 0.2;   ///< width over which grey falls from 1 to 0 [m]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("rod_half_width", rod_half_width);
    visitor("edge_softness", edge_softness);
  }

  std::vector<std::string> problems() const;
};

/// A rod from `start` to start + length (sin angle, -cos angle). A rod with angle 0 points down;
/// positive angles turn counter-clockwise. The origin is the centre of the image, x points to the
/// right and y points upwards.
struct Rod {
  Eigen::Vector2d start;  ///< [m]
  double angle;           ///< [rad]
  double length;          ///< [m]

  Eigen::Vector2d end() const;
};

/// Draws bright rods on black:
///
///   grey(p) = clamp((rod_half_width - distance(p, nearest rod)) / edge_softness + 1/2, 0, 1)
///
/// where p is the centre of a pixel. The distance is computed in closed form, so the image is a
/// continuous function of the angles. With the default softness, a change of one degree changes the
/// image.
/// Deviation: the paper does not describe its renderer; this one is our choice.
class RodRenderer {
 public:
  /// @param size  width and height of the image [pixels]
  /// @throws std::invalid_argument if the look has problems
  RodRenderer(int size, const RodLook& look);

  /// @param rods  at least one rod; all values finite
  RenderedImage render(const std::vector<Rod>& rods) const;

 private:
  int size_;
  double rod_half_width_;
  double edge_softness_;
  Eigen::ArrayXd offsets_;  ///< x of the pixel centres of a row, from left to right [m] [size]
};

}  // namespace ddm
