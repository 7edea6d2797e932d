// Writes the seeds of this package's fuzz targets that are not text: ddm_msgs_fuzz_seeds FOLDER.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_images/image_codec.h>
#include <ddm_msgs/testing/seed_files.h>

#include <string>

namespace ddm {
namespace testing {
namespace {

/// An image with a byte after each row, if `padding`.
sensor_msgs::Image image(const std::string& encoding, std::uint32_t width, std::uint32_t height,
                         std::uint32_t pixel_bytes, bool padding) {
  sensor_msgs::Image image;
  image.header.stamp = ros::Time(1.5);
  image.header.frame_id = "camera";
  image.encoding = encoding;
  image.width = width;
  image.height = height;
  image.step = width * pixel_bytes + (padding ? 1 : 0);
  for (std::uint32_t i = 0; i < image.step * height; ++i) {
    image.data.push_back(static_cast<std::uint8_t>(37 * i % 64));  // as floats: small
  }
  return image;
}

void writeImages(const SeedFolder& folder) {
  const std::string whole("\x04\x00", 2);
  const std::string cropped("\x03\x01\x01\x00\x04\x03", 6);
  folder.write("mono8", whole + bytesOf(image("mono8", 4, 4, 1, false)));
  folder.write("mono8_cropped", cropped + bytesOf(image("mono8", 6, 5, 1, true)));
  folder.write("rgb8", whole + bytesOf(image("rgb8", 8, 6, 3, true)));
  folder.write("bgra16", whole + bytesOf(image("bgra16", 5, 4, 8, false)));
  folder.write("bayer", whole + bytesOf(image("bayer_rggb8", 6, 6, 1, false)));
  folder.write("yuv422", whole + bytesOf(image("yuv422", 6, 4, 2, false)));
  folder.write("float", whole + bytesOf(image("32FC1", 5, 5, 4, false)));
  folder.write("double", whole + bytesOf(image("64FC1", 4, 4, 8, false)));
}

}  // namespace
}  // namespace testing
}  // namespace ddm

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  ddm::testing::writeImages(ddm::testing::SeedFolder(std::string(argv[1]) + "/image_message"));
  return 0;
}
