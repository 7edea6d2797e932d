// Images as pictures in files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

#include <string>

namespace ddm {

/// The picture in grey, as large as it is; any format that OpenCV reads.
/// @throws std::invalid_argument with the path if it is none
sensor_msgs::Image readPicture(const std::string& path);

/// @param image  mono8 or rgb8; the format is that of the path's suffix
/// @throws std::runtime_error with the path
void writePicture(const std::string& path, const sensor_msgs::Image& image);

}  // namespace ddm
