// What ROS tells of a camera: its lens, and where it stands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/CameraInfo.h>

#include "ddm_sim/camera_model.h"

namespace ddm {

/// A pinhole without distortion, in the camera's optical frame; without a stamp.
///
///   f = height / 2 / tan(fovy / 2),   c = ((width - 1) / 2, (height - 1) / 2)
///
/// because the middle of the first pixel is (0, 0).
sensor_msgs::CameraInfo cameraInfoOf(const CameraModel& camera);

/// The optical frame in the frame "world"; without a stamp.
/// @pre the camera is fixed
geometry_msgs::TransformStamped opticalFrameOf(const CameraModel& camera);

}  // namespace ddm
