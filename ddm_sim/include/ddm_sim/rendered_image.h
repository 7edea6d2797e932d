// A rendered image of a plant, and the pinhole camera model of the renderer.
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

/// A rendered image. Rows run from top to bottom, pixels of a row from left to right; the channels
/// of a pixel are adjacent.
struct RenderedImage {
  int width = 0;                    ///< [pixels]
  int height = 0;                   ///< [pixels]
  int channels = 1;                 ///< 1: grey; 3: red, green, blue
  std::vector<std::uint8_t> bytes;  ///< round(255 v), v in [0, 1]   [width * height * channels]

  /// Share of each pixel that the plant covers; 255 means all of it. The plant hides the background
  /// there, even if the plant itself is dark. Empty if the renderer does not supply the cover.
  ///                                                             [width * height] or [0]
  std::vector<std::uint8_t> cover;

  std::size_t numPixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t numBytes() const { return numPixels() * static_cast<std::size_t>(channels); }
};

/// A square grey image of a bright plant on black. The grey value of a pixel is also its cover.
inline RenderedImage brightOnBlack(int size, std::vector<std::uint8_t> bytes) {
  return {size, size, 1, bytes, std::move(bytes)};
}

/// A pinhole camera without distortion and with square pixels, whose optical axis goes through the
/// middle of its images.
struct CameraModel {
  std::string name;    ///< name of the camera in the scene; its optical frame is NAME_optical_frame
  int width = 0;       ///< [pixels]
  int height = 0;      ///< [pixels]
  double fovy = 0.0;   ///< vertical field of view [rad]
  bool fixed = false;  ///< true if the camera does not move in the world

  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< position in the world [m]

  /// Rotation from the optical frame to the world. The optical frame has x to the right, y down, z
  /// ahead.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();

  double focalLength() const { return 0.5 * height / std::tan(0.5 * fovy); }  ///< [pixels]
};

}  // namespace ddm
