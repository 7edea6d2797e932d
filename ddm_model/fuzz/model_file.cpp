// Fuzz target: a model file, as it is and with its header repaired.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/model_file.h>
#include <ddm_msgs/testing/fuzzing.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

namespace ddm {
namespace {

using testing::accepts;
using testing::require;

/// "DDMMODEL" | version, uint32 | size, uint64 | CRC-32 | content: all but version and content are
/// made right. What has no room for a header stays as it is.
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

/// Whether a model that was read and written again has the same content, bit for bit.
bool comesBack(const std::string& read, const std::string& written) {
  constexpr std::size_t kContentAt = 24;
  return read.compare(kContentAt, std::string::npos, written, kContentAt, std::string::npos) == 0;
}

void checkModel(const Ddm& model) {
  const auto num_pixels = static_cast<std::size_t>(model.imageSize()) * model.imageSize();
  require(model.theta().allFinite() && model.pca().variance.allFinite(), "numbers are finite");
  require(std::isfinite(model.info().v_r) && std::isfinite(model.info().v_p), "errors are finite");
  require(model.options().problems().empty(), "options are valid");
  require(model.encode(Grey(num_pixels, 255)).size() == model.featureDim(),
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

}  // namespace
}  // namespace ddm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  ddm::checkFile(bytes);
  ddm::checkFile(ddm::repaired(bytes));
  return 0;
}
