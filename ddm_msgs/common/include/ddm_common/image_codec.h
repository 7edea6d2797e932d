// Converts camera messages to the grey values of the paper's y, and reads and writes image files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <string>
#include <vector>

namespace ddm {

/// The part of an image that is used. A width or height of 0 reaches to the edge of the image.
struct ImageCrop {
  int x = 0;       ///< first column [pixels]
  int y = 0;       ///< first row [pixels]
  int width = 0;   ///< number of columns [pixels]
  int height = 0;  ///< number of rows [pixels]
};

/// Converts a camera image to grey values of the size that the model uses.
///
///   y_i = k_i / 255,   k = decodeImage(image, size),   i row by row from the top left corner
///
/// A mono8 (or 8UC1) image of size x size without padding is returned byte for byte. Every other
/// image is converted to grey, then cropped, then cut to its central square (an odd column is
/// removed on the right, an odd row at the bottom), and then resized by area averaging
/// (cv::INTER_AREA).
///
/// Encodings, in lower or upper case: mono8, mono16, rgb8, bgr8, rgba8, bgra8 and their 16 bit
/// forms; bayer_*8, bayer_*16; YUV 4:2:2 under the names yuv422, uyvy, uyvy422, yuv422_uyvy and
/// yuyv, yuy2, yuyv422, yuv422_yuy2; 8UC1/3/4 and 16UC1/3/4 (three channels in OpenCV's order blue,
/// green, red); 32FC1 and 64FC1 with grey values in [0, 1]. The luma of YUV images is used without
/// conversion. 16 bit values are divided by 257, so that 65535 becomes 255. Floats become
/// k = round(255 grey). Pixels may be big-endian.
///
/// @param image  untrusted message; all of its fields are checked
/// @param size   width and height of the result                                 [1 ... 16384]
/// @param crop   part of the image that is used; the whole image by default
/// @return       grey values k                                                  [size * size]
/// @throws std::invalid_argument if the size is out of range, the image is empty or larger than
///         16384 x 16384, the encoding is not listed above, step or data do not match the image
///         size, a float is outside [0, 1] or NaN, or the crop extends beyond the image
std::vector<std::uint8_t> decodeImage(const sensor_msgs::Image& image, int size,
                                      const ImageCrop& crop = ImageCrop());

/// Decompresses a JPEG, PNG or other image file in colour: bgr8, or bgr16 if it has 16 bits per
/// channel.
/// @throws std::invalid_argument if OpenCV cannot decode the data, or a JPEG is truncated
sensor_msgs::Image unpacked(const sensor_msgs::CompressedImage& image);

/// Makes a mono8 image without padding, the inverse of decodeImage():
///
///   decodeImage(encodeImage(k, size, ...), size) == k
///
/// @param grey  grey values k, row by row from the top left corner              [size * size]
/// @param size  width and height                                                [1 ... 16384]
/// @throws std::invalid_argument if the size is out of range or `grey` has the wrong length
sensor_msgs::Image encodeImage(const std::vector<std::uint8_t>& grey, int size,
                               const ros::Time& stamp, const std::string& frame_id);

/// Reads an image file as grey values at its own size; any format that OpenCV reads.
/// @throws std::runtime_error with the path if there is no such regular file, std::invalid_argument
///         with the path if the file is not an image
sensor_msgs::Image readImageFile(const std::string& path);

/// Writes an image file; the suffix of the path determines the format.
/// @param image  mono8 or rgb8
/// @throws std::runtime_error with the path
void writeImageFile(const std::string& path, const sensor_msgs::Image& image);

}  // namespace ddm
