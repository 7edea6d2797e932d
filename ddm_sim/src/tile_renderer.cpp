// Camera picture of a square tile with soft edges.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/tile_renderer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace ddm {
namespace {

/// Fraction of the window of each pixel of a line, [j + 1/2 - softness / 2, j + 1/2 + softness /
/// 2], that [middle - width / 2, middle + width / 2] covers.
std::vector<double> coverage(int size, double middle, double width, double softness) {
  const double first = middle - width / 2;
  const double last = middle + width / 2;
  const double margin = (softness - 1.0) / 2;  // of the window around the pixel
  std::vector<double> out(size);
  for (int j = 0; j < size; ++j) {
    const double overlap = std::min(last, j + 1.0 + margin) - std::max(first, j - margin);
    out[j] = std::max(0.0, overlap) / softness;
  }
  return out;
}

}  // namespace

TileRenderer::TileRenderer(int size, double tile_width, double softness)
    : size_(size), tile_width_(tile_width), softness_(softness) {
  if (size < 1) {
    throw std::invalid_argument("TileRenderer: size must be >= 1, got " + std::to_string(size));
  }
  if (!(tile_width > 0.0) || !std::isfinite(tile_width)) {
    throw std::invalid_argument("TileRenderer: tile_width must be > 0 and finite, got " +
                                std::to_string(tile_width));
  }
  if (!(softness >= 1.0) || !std::isfinite(softness)) {
    throw std::invalid_argument("TileRenderer: softness must be >= 1 and finite, got " +
                                std::to_string(softness));
  }
}

Picture TileRenderer::render(const Eigen::Vector2d& centre) const {
  const std::vector<double> columns = coverage(size_, centre.x(), tile_width_, softness_);
  const std::vector<double> rows = coverage(size_, centre.y(), tile_width_, softness_);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(static_cast<std::size_t>(size_) * size_);
  for (const double row : rows) {
    for (const double column : columns) {
      bytes.push_back(static_cast<std::uint8_t>(255.0 * row * column + 0.5));
    }
  }
  return brightOnBlack(size_, std::move(bytes));
}

}  // namespace ddm
