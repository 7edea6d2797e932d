// The goal as a picture in a file.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

#include <string>

namespace ddm {

bool goalPictureExists(const std::string& path);

/// The picture in grey, as large as it is; any format that OpenCV reads.
/// @throws std::invalid_argument with the path if it is none
sensor_msgs::Image readGoalPicture(const std::string& path);

/// @param goal  mono8 without padding; the format is that of the path's suffix
/// @throws std::runtime_error with the path and the reason
void writeGoalPicture(const std::string& path, const sensor_msgs::Image& goal);

}  // namespace ddm
