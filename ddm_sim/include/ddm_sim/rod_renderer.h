// Camera picture of a rod that turns about the image centre, with soft edges.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "ddm_sim/plant_options.h"

namespace ddm {

/// Draws y, the image of the paper's pendulum: a bright rod on black.
///
///   grey(p) = clamp((rod_half_width - distance(p, rod)) / edge_softness + 1/2, 0, 1)
///
/// with p the centre of a pixel and the rod the segment from the image centre (the pivot) to
/// length (sin angle, -cos angle): angle 0 hangs (points down in the image), counter-clockwise is
/// positive, so pi/2 points right. The distance is exact and nothing is sampled: the image is a
/// continuous function of the angle, and with the default softness one degree changes it.
/// Deviation: the paper does not describe its renderer; this one is ours.
class RodRenderer {
 public:
  /// @param rod_length  [m]
  /// @throws std::invalid_argument if the options have problems or rod_length is not > 0
  RodRenderer(const CameraOptions& options, double rod_length);

  /// @param angle  [rad], finite
  /// @return k = round(255 grey), rows from top to bottom                            [size * size]
  std::vector<std::uint8_t> render(double angle) const;

  int size() const { return size_; }  ///< width and height of the image [pixels]

 private:
  int size_;
  double rod_length_;
  double rod_half_width_;
  double edge_softness_;
  Eigen::ArrayXd offsets_;  ///< x of the pixel centres of a row, from left to right [m]     [size]
};

}  // namespace ddm
