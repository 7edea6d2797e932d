// Images: as camera messages, as the grey values of the paper's y, as pictures in files.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <string>
#include <vector>

namespace ddm {

/// The pixels of an image that count; a width or height of 0 reaches to its edge.
struct ImageCrop {
  int x = 0;       ///< first column
  int y = 0;       ///< first row
  int width = 0;   ///< columns
  int height = 0;  ///< rows
};

/// Grey values of a camera image at the size that the model works with.
///
///   y_i = k_i / 255,   k = decodeImage(image, size),   i row by row from the top left corner
///
/// A mono8 (or 8UC1) image of size x size without padding is returned byte for byte. Any other is
/// turned into grey first, then cropped, then cut to its central square if it is not square (an odd
/// column or row is left out on the right or at the bottom), then resized by area averaging
/// (cv::INTER_AREA).
///
/// Encodings, in small or capital letters: mono8, mono16, rgb8, bgr8, rgba8, bgra8 and their 16 bit
/// forms; bayer_*8, bayer_*16; YUV 4:2:2, whose luma is used as it is sent, under the names yuv422,
/// uyvy, uyvy422, yuv422_uyvy and yuyv, yuy2, yuyv422, yuv422_yuy2; 8UC1/3/4 and 16UC1/3/4 (three
/// channels in OpenCV's order blue, green, red); 32FC1 and 64FC1 with grey values in [0, 1]. 16 bit
/// is divided by 257, so that 65535 becomes 255. Floats become k = round(255 grey). Pixels may be
/// big-endian.
///
/// @param image  as it came over the wire; nothing in it is trusted
/// @param size   width and height of the result                                 [1 ... 16384]
/// @param crop   what of it is looked at                                        [all of it]
/// @return       grey values k                                                  [size * size]
/// @throws std::invalid_argument if the size is out of range, the image is empty or larger than
///         16384 x 16384, its encoding is not one of the above, its step or data do not fit its
///         size, a float is outside [0, 1] or NaN, or the crop reaches beyond the image
std::vector<std::uint8_t> decodeImage(const sensor_msgs::Image& image, int size,
                                      const ImageCrop& crop = ImageCrop());

/// An image from its JPEG, PNG or other bytes, in colour: bgr8, or bgr16 if they have 16 bits.
/// @throws std::invalid_argument if OpenCV cannot read them, or a JPEG ends early
sensor_msgs::Image unpacked(const sensor_msgs::CompressedImage& image);

/// The inverse of decodeImage(): a mono8 image without padding. decodeImage(encodeImage(k, size, ...), size) == k.
///
/// @param grey  grey values k, row by row from the top left corner              [size * size]
/// @param size  width and height                                                [1 ... 16384]
/// @throws std::invalid_argument if the size is out of range or `grey` has another length
sensor_msgs::Image encodeImage(const std::vector<std::uint8_t>& grey, int size,
                               const ros::Time& stamp, const std::string& frame_id);

/// The picture in grey, as large as it is; any format that OpenCV reads.
/// @throws std::invalid_argument with the path if it is none
sensor_msgs::Image readPicture(const std::string& path);

/// @param image  mono8 or rgb8; the format is that of the path's suffix
/// @throws std::runtime_error with the path
void writePicture(const std::string& path, const sensor_msgs::Image& image);

}  // namespace ddm
