// Converts a rendered image to the message of a camera.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/plant.h>
#include <ddm_sim/rendered_image.h>
#include <ros/time.h>
#include <sensor_msgs/fill_image.h>

#include <optional>
#include <string>

namespace ddm {

/// Name of the optical frame by the ROS convention: NAME_optical_frame, or "camera" if the renderer
/// has no pinhole model.
inline std::string opticalFrame(const std::optional<CameraModel>& camera) {
  return camera ? camera->name + "_optical_frame" : "camera";
}

/// A mono8 or rgb8 message without padding.
inline sensor_msgs::Image imageMessage(const RenderedImage& rendered, const ros::Time& stamp,
                                       const std::string& frame = "camera") {
  sensor_msgs::Image image;
  image.header.stamp = stamp;
  image.header.frame_id = frame;
  sensor_msgs::fillImage(image, rendered.channels == 1 ? "mono8" : "rgb8", rendered.height,
                         rendered.width, rendered.width * rendered.channels, rendered.bytes.data());
  return image;
}

}  // namespace ddm
