// What ROS tells of a camera: its lens, and where it stands.
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_info.h"

#include <ddm_plant_plugin/picture_message.h>

#include <Eigen/Geometry>

namespace ddm {

sensor_msgs::CameraInfo cameraInfoOf(const CameraModel& camera) {
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

geometry_msgs::TransformStamped opticalFrameOf(const CameraModel& camera) {
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
