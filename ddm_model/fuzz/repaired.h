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

/// Version 2 of the format, which serialiseModel() writes; version 1 is only read.
inline bool isOfThisVersion(const std::string& bytes) { return bytes.size() > 8 && bytes[8] == 2; }

}  // namespace testing
}  // namespace ddm
