// Picture of rods with soft edges: the link of a pendulum, the links of an arm.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ddm_sim/picture.h"

namespace ddm {

/// From the centre of the image, where the first rod begins, to its edge [m].
constexpr double kHalfExtent = 1.2;

/// How rods look. Keys of the block `plant` of each plant that is made of rods.
struct RodLook {
  double rod_half_width = 0.1;  ///< half the width of a rod [m]
  double edge_softness = 0.2;   ///< width over which grey falls from 1 to 0 [m]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("rod_half_width", rod_half_width);
    visitor("edge_softness", edge_softness);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// A rod from `start` to start + length (sin angle, -cos angle): angle 0 points down,
/// counter-clockwise is positive. The origin is the image centre, y points upwards.
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
/// with p the centre of a pixel. The distance is exact and nothing is sampled: the image is a
/// continuous function of the angles, and with the default softness one degree changes it.
/// Deviation: the paper does not describe its renderer; this one is ours.
class RodRenderer {
 public:
  /// @param size  width and height of the image [pixels]
  /// @throws std::invalid_argument if the look has problems
  RodRenderer(int size, const RodLook& look);

  /// @param rods  one or more, all values finite
  Picture render(const std::vector<Rod>& rods) const;

 private:
  int size_;
  double rod_half_width_;
  double edge_softness_;
  Eigen::ArrayXd offsets_;  ///< x of the pixel centres of a row, from left to right [m]     [size]
};

}  // namespace ddm
