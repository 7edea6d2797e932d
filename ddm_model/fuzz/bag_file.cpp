// Fuzz target: the bytes of a bag.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_reader.h>
#include <ddm_msgs/testing/fuzzing.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace ddm {
namespace {

using testing::require;

/// What holds for all that was read from a bag.
void checkContent(const BagContent& content, int image_size) {
  const DataSet& data = content.data;
  const auto num_frames = static_cast<std::size_t>(data.numFrames());
  require(num_frames > 0, "a bag has a frame");
  require(data.imageSize() == image_size, "images have the size that was asked for");
  require(data.torqueDim() >= 1 && data.torques().allFinite(), "torques are finite");
  require(data.torques().cols() == data.numFrames(), "each frame has a torque");
  require(content.times.size() == num_frames, "each frame has a time");
  require(content.times[0] == 0.0 && std::is_sorted(content.times.begin(), content.times.end()),
          "times rise from zero");
  require(std::isfinite(content.interval) && content.interval >= 0.0, "the interval is a time");
  require(!content.camera.empty(), "the camera is told");
  for (Eigen::Index i = 0; i < data.numFrames(); ++i) {
    require(data.image(i).size() == static_cast<std::size_t>(image_size) * image_size,
            "images are whole");
  }
}

}  // namespace
}  // namespace ddm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kImageSize = 4;
  std::istringstream bag(std::string(reinterpret_cast<const char*>(data), size));
  ddm::testing::accepts<std::runtime_error>([&] {
    ddm::checkContent(ddm::readBagBytes(&bag, kImageSize, ddm::BagOptions()), kImageSize);
  });
  return 0;
}
