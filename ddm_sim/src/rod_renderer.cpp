// Renderer for rods with soft edges.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/rod_renderer.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ddm {

std::vector<std::string> RodLook::problems() const {
  OptionChecks plant("plant");
  plant.requirePositive("rod_half_width", rod_half_width);
  plant.requirePositive("edge_softness", edge_softness);
  return plant.problems();
}

Eigen::Vector2d Rod::end() const {
  return start + length * Eigen::Vector2d(std::sin(angle), -std::cos(angle));
}

RodRenderer::RodRenderer(int size, const RodLook& look)
    : size_(size),
      rod_half_width_(checked(look).rod_half_width),
      edge_softness_(look.edge_softness),
      offsets_(size) {
  for (int j = 0; j < size_; ++j) {
    offsets_[j] = (2 * j + 1 - size_) * kHalfExtent / size_;  // exactly antisymmetric
  }
}

RenderedImage RodRenderer::render(const std::vector<Rod>& rods) const {
  const double gain = 255.0 / edge_softness_;
  const double at_centre_line = gain * rod_half_width_ + 127.5;

  // Squared distance of each pixel centre to the nearest rod [m^2].
  std::vector<double> distances(static_cast<std::size_t>(size_) * size_,
                                std::numeric_limits<double>::max());
  for (const Rod& rod : rods) {
    const double direction_x = std::sin(rod.angle);
    const double direction_y = -std::cos(rod.angle);
    double* distance = distances.data();
    for (int i = 0; i < size_; ++i) {
      const double y = -offsets_[i] - rod.start.y();  // image rows run downwards
      for (int j = 0; j < size_; ++j, ++distance) {
        const double x = offsets_[j] - rod.start.x();
        const double along = std::min(std::max(x * direction_x + y * direction_y, 0.0), rod.length);
        const double dx = x - along * direction_x;
        const double dy = y - along * direction_y;
        *distance = std::min(*distance, dx * dx + dy * dy);
      }
    }
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(distances.size());
  for (const double distance : distances) {
    const double level = at_centre_line - gain * std::sqrt(distance);
    bytes.push_back(static_cast<std::uint8_t>(std::min(std::max(level, 0.0), 255.0) + 0.5));
  }
  return brightOnBlack(size_, std::move(bytes));
}

}  // namespace ddm
