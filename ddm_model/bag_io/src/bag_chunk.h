// A chunk of a bag: messages, often compressed.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace ddm {

/// @param compression  none, lz4 or bz2
/// @param size         that the result must have                                 [bytes]
/// @throws std::runtime_error if the compression is another, the size is beyond 256 MB or more
///         than this many bytes can hold, or the data are damaged
std::string decompressChunk(const std::string& compression, const std::string& data,
                            std::uint32_t size);

}  // namespace ddm
