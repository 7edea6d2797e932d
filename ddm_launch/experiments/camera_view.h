// Photographs as messages and as a learner sees them, where no topic lies between the two.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_images/image_codec.h>
#include <ddm_model/data_set.h>

#include <cstdint>
#include <vector>

namespace ddm {

/// The message that sim_node would publish of a photograph.
/// @param size  `camera/size` [pixels]
inline sensor_msgs::Image imageMessage(const std::vector<std::uint8_t>& photograph, int size,
                                       const ros::Time& stamp) {
  return encodeImage(photograph, size, stamp, "camera");
}

/// A photograph as a learner sees it, through the codec that bags and nodes use.
/// @param size        `camera/size` [pixels]
/// @param image_size  `image/size` [pixels]
inline Grey cameraView(const std::vector<std::uint8_t>& photograph, int size, int image_size) {
  return decodeImage(imageMessage(photograph, size, ros::Time()), image_size);
}

}  // namespace ddm
