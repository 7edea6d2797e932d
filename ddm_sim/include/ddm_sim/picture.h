// A picture: what a plant looks like, and what a camera makes of it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace ddm {

/// Rows from top to bottom, in each row pixels from left to right, in each pixel its channels.
struct Picture {
  int width = 0;                    ///< [pixels]
  int height = 0;                   ///< [pixels]
  int channels = 1;                 ///< 1: grey; 3: red, green, blue
  std::vector<std::uint8_t> bytes;  ///< round(255 v), v in [0, 1]   [width * height * channels]

  /// How much of each pixel the plant covers, 255: all of it. There it hides what lies behind,
  /// however dark it is. Empty: not known.                                  [width * height] or [0]
  std::vector<std::uint8_t> cover;

  std::size_t numPixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t numBytes() const { return numPixels() * static_cast<std::size_t>(channels); }
};

/// A square grey picture that is bright where the plant is and black elsewhere, so that it covers
/// as much of a pixel as the pixel is bright.
inline Picture brightOnBlack(int size, std::vector<std::uint8_t> bytes) {
  return {size, size, 1, bytes, std::move(bytes)};
}

}  // namespace ddm
