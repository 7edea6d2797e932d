// A picture as the message that a camera would publish.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/picture.h>
#include <ros/time.h>
#include <sensor_msgs/Image.h>

namespace ddm {

/// mono8 or rgb8, without padding, in the frame "camera".
inline sensor_msgs::Image imageMessage(const Picture& picture, const ros::Time& stamp) {
  sensor_msgs::Image image;
  image.header.stamp = stamp;
  image.header.frame_id = "camera";
  image.width = static_cast<std::uint32_t>(picture.width);
  image.height = static_cast<std::uint32_t>(picture.height);
  image.encoding = picture.channels == 1 ? "mono8" : "rgb8";
  image.is_bigendian = 0;
  image.step = image.width * static_cast<std::uint32_t>(picture.channels);
  image.data = picture.bytes;
  return image;
}

}  // namespace ddm
