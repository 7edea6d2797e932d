// Fuzz targets of ddm_model: bags and model files.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_reader.h>
#include <ddm_model/model_file.h>
#include <ddm_msgs/testing/fuzzing.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

namespace ddm {
namespace {

using testing::accepts;
using testing::require;

/// Requires the properties of everything that was read from a bag.
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

/// Reads the bytes as a bag.
void bagFile(const std::uint8_t* data, std::size_t size) {
  constexpr int kImageSize = 4;
  static const testing::MemoryFile bag;
  bag.write(data, size);
  accepts<std::runtime_error>(
      [&] { checkContent(readBag(bag.path(), kImageSize, BagOptions()), kImageSize); });
}

/// Corrects the magic number, the size and the checksum in the header of a model file ("DDMMODEL" |
/// version, uint32 | size, uint64 | CRC-32 | content). Bytes too short for a header stay as they
/// are.
std::string repaired(std::string bytes) {
  constexpr std::size_t kSizeAt = 12, kChecksumAt = 20, kContentAt = 24;
  if (bytes.size() < kContentAt) return bytes;
  bytes.replace(0, 8, "DDMMODEL");
  const std::uint64_t size = bytes.size() - kContentAt;
  const auto crc =
      static_cast<std::uint32_t>(std::stoul(checksum(bytes.substr(kContentAt)), nullptr, 16));
  std::memcpy(&bytes[kSizeAt], &size, sizeof(size));
  std::memcpy(&bytes[kChecksumAt], &crc, sizeof(crc));
  return bytes;
}

/// @return whether a model that was read and written again has the same content, bit for bit
bool comesBack(const std::string& read, const std::string& written) {
  constexpr std::size_t kContentAt = 24;
  return read.compare(kContentAt, std::string::npos, written, kContentAt, std::string::npos) == 0;
}

void checkModel(const Ddm& model) {
  const auto num_pixels = static_cast<std::size_t>(model.imageSize()) * model.imageSize();
  require(model.theta().allFinite() && model.pca().variance.allFinite(), "numbers are finite");
  require(std::isfinite(model.info().v_r) && std::isfinite(model.info().v_p), "errors are finite");
  require(model.options().problems().empty(), "options are valid");
  require(model.encode(Image(num_pixels, 255)).size() == model.featureDim(),
          "an image has a feature");
  require(model.decode(Eigen::VectorXd::Zero(model.featureDim())).size() == num_pixels,
          "a feature has an image");
  if (model.hasGoal()) require(model.goalFeature().allFinite(), "the goal's feature is finite");
}

void checkFile(const std::string& bytes) {
  std::optional<Ddm> model;
  const auto read = [&] { model.emplace(deserialiseModel(bytes, "fuzz")); };
  if (!accepts<std::runtime_error>(read)) return;
  checkModel(*model);
  const std::string written = serialiseModel(*model);
  require(comesBack(bytes, written), "a model comes back bit for bit");
  require(serialiseModel(deserialiseModel(written, "fuzz")) == written, "what is written is read");
}

/// Reads the bytes as a model file, unchanged and with a corrected header.
void modelFile(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  checkFile(bytes);
  checkFile(repaired(bytes));
}

}  // namespace
}  // namespace ddm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ddm::testing::FuzzTarget target =
      ddm::testing::chosenTarget({{"bag_file", ddm::bagFile}, {"model_file", ddm::modelFile}});
  target(data, size);
  return 0;
}
