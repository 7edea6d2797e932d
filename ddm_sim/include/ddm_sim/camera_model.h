// A pinhole camera: how big its pictures are, what it sees, where it stands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>

namespace ddm {

/// Of a plant whose pictures are those of a real camera, without distortion, with square pixels,
/// its optical axis through the middle of the picture.
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
