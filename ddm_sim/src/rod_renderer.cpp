// Camera picture of a rod that turns about the image centre, with soft edges.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/rod_renderer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ddm {

RodRenderer::RodRenderer(const CameraOptions& options, double rod_length)
    : size_(options.size),
      rod_length_(rod_length),
      rod_half_width_(options.rod_half_width),
      edge_softness_(options.edge_softness) {
  requireNone(options.problems());
  if (!(rod_length > 0.0) || !std::isfinite(rod_length)) {
    throw std::invalid_argument("RodRenderer: rod_length must be > 0 and finite, got " +
                                std::to_string(rod_length));
  }
  offsets_.resize(size_);
  for (int j = 0; j < size_; ++j) {
    offsets_[j] = (2 * j + 1 - size_) * options.half_extent / size_;  // exactly antisymmetric
  }
}

std::vector<std::uint8_t> RodRenderer::render(double angle) const {
  const double direction_x = std::sin(angle);
  const double direction_y = -std::cos(angle);
  const double gain = 255.0 / edge_softness_;
  const double at_centre_line = gain * rod_half_width_ + 127.5;

  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size_) * size_);
  std::uint8_t* byte = bytes.data();
  for (int i = 0; i < size_; ++i) {
    const double y = -offsets_[i];  // image rows run downwards
    for (int j = 0; j < size_; ++j) {
      const double x = offsets_[j];
      const double along = std::min(std::max(x * direction_x + y * direction_y, 0.0), rod_length_);
      const double dx = x - along * direction_x;
      const double dy = y - along * direction_y;
      const double level = at_centre_line - gain * std::sqrt(dx * dx + dy * dy);
      *byte++ = static_cast<std::uint8_t>(std::min(std::max(level, 0.0), 255.0) + 0.5);
    }
  }
  return bytes;
}

}  // namespace ddm
