// A rendered image of a plant, and the pinhole camera that it may come from.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ddm {

/// Rows from top to bottom, in each row pixels from left to right, in each pixel its channels.
struct Picture {
  int width = 0;                    ///< [pixels]
  int height = 0;                   ///< [pixels]
  int channels = 1;                 ///< 1: grey; 3: red, green, blue
  std::vector<std::uint8_t> bytes;  ///< round(255 v), v in [0, 1]   [width * height * channels]

  /// How much of each pixel the plant covers, 255: all of it. There it hides what lies behind,
  /// however dark it is. Empty: not known.                                  [width * height] or [0]
  std::vector<std::uint8_t> cover;

  std::size_t numPixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t numBytes() const { return numPixels() * static_cast<std::size_t>(channels); }
};

/// A square grey picture that is bright where the plant is and black elsewhere, so that it covers
/// as much of a pixel as the pixel is bright.
inline Picture brightOnBlack(int size, std::vector<std::uint8_t> bytes) {
  return {size, size, 1, bytes, std::move(bytes)};
}

/// A camera without distortion, with square pixels, whose optical axis goes through the middle of its
/// images.
struct CameraModel {
  std::string name;    ///< as the scene calls it; its optical frame is NAME_optical_frame
  int width = 0;       ///< [pixels]
  int height = 0;      ///< [pixels]
  double fovy = 0.0;   ///< vertical field of view [rad]
  bool fixed = false;  ///< stands still in the world, at `position`

  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in the world [m]

  /// Optical frame in the world: x to the right, y down, z ahead.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();

  double focalLength() const { return 0.5 * height / std::tan(0.5 * fovy); }  ///< [pixels]
};

}  // namespace ddm
