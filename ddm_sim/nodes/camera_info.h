// What ROS tells of a camera: its lens, and where it stands.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_plant_plugin/picture_message.h>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/CameraInfo.h>

#include <Eigen/Geometry>

#include "ddm_sim/camera_model.h"

namespace ddm {

/// A pinhole without distortion, in the camera's optical frame; without a stamp.
///
///   f = height / 2 / tan(fovy / 2),   c = ((width - 1) / 2, (height - 1) / 2)
///
/// because the middle of the first pixel is (0, 0).
inline sensor_msgs::CameraInfo cameraInfoOf(const CameraModel& camera) {
  const double f = camera.focalLength();
  const double cx = 0.5 * (camera.width - 1);
  const double cy = 0.5 * (camera.height - 1);
  sensor_msgs::CameraInfo info;
  info.header.frame_id = opticalFrame(camera);
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// The optical frame in the frame "world"; without a stamp.
/// @pre the camera is fixed
inline geometry_msgs::TransformStamped opticalFrameOf(const CameraModel& camera) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(camera.rotation).normalized();
  geometry_msgs::TransformStamped frame;
  frame.header.frame_id = "world";
  frame.child_frame_id = opticalFrame(camera);
  frame.transform.translation.x = camera.position.x();
  frame.transform.translation.y = camera.position.y();
  frame.transform.translation.z = camera.position.z();
  frame.transform.rotation.x = rotation.x();
  frame.transform.rotation.y = rotation.y();
  frame.transform.rotation.z = rotation.z();
  frame.transform.rotation.w = rotation.w();
  return frame;
}

}  // namespace ddm
