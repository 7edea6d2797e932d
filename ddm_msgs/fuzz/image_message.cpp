// Fuzz target: bytes to an image message, to grey values.
// SPDX-License-Identifier: BSD-3-Clause
//
// Input: size (1 byte), then 1 and a crop (4 bytes) or 0 for none, then the message.
#include <ddm_images/image_codec.h>
#include <ddm_msgs/message_bytes.h>
#include <ddm_msgs/testing/fuzzing.h>

using ddm::testing::accepts;
using ddm::testing::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ddm::testing::FuzzBytes bytes(data, size);
  const int side = bytes.number<std::uint8_t>() % 64;  // 0 is refused
  ddm::ImageCrop crop;
  if (bytes.number<std::uint8_t>() % 2 != 0) {
    crop.x = bytes.number<std::int8_t>();
    crop.y = bytes.number<std::int8_t>();
    crop.width = bytes.number<std::int8_t>();
    crop.height = bytes.number<std::int8_t>();
  }
  const std::string wire = bytes.rest();
  sensor_msgs::Image image;
  const auto parse = [&] {
    image = ddm::messageFromBytes<sensor_msgs::Image>(wire.data(), wire.size());
  };
  if (!accepts<std::runtime_error>(parse)) return 0;

  std::vector<std::uint8_t> grey;
  const auto decode = [&] { grey = ddm::decodeImage(image, side, crop); };
  if (!accepts<std::invalid_argument>(decode)) return 0;
  require(grey.size() == static_cast<std::size_t>(side) * side, "an image has size x size pixels");
  require(grey == ddm::decodeImage(image, side, crop), "equal images give equal pixels");
  const sensor_msgs::Image again = ddm::encodeImage(grey, side, image.header.stamp, "camera");
  require(ddm::decodeImage(again, side) == grey, "a mono8 image of this size comes back");
  return 0;
}
