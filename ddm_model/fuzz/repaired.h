// A model file whose header fits its content, so that fuzzing comes behind the checksum.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/model_file.h>

#include <cstdint>
#include <cstring>
#include <string>

namespace ddm {
namespace testing {

/// "DDMMODEL" | version, uint32 | size, uint64 | CRC-32 | content: all but version and content are
/// made right. What has no room for a header stays as it is.
inline std::string repaired(std::string bytes) {
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

/// Whether what was read and written again is bit for bit as it was. Not looked at where it was of
/// another version of the format; of an ensemble, which older programs wrote, only the first model
/// is kept, and the last number written is how many others there are.
inline bool comesBack(const std::string& read, const std::string& written) {
  constexpr std::size_t kVersionAt = 8, kContentAt = 24, kNumOthers = 4;
  if (read[kVersionAt] != written[kVersionAt]) return true;
  const std::size_t size = written.size() - kContentAt - kNumOthers;
  return read.compare(kContentAt, size, written, kContentAt, size) == 0;
}

}  // namespace testing
}  // namespace ddm
