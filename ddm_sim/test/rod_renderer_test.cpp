// Tests of the rod renderer: the grey values of one rod, and of several.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/rod_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ddm {
namespace {

constexpr int kSize = 51;

/// Grey value of one rod by the published formula, before it is rounded.
double greyOf(const Rod& rod, int row, int column) {
  const double x = (column - 25) * 2.4 / kSize - rod.start.x();
  const double y = (25 - row) * 2.4 / kSize - rod.start.y();
  const double along = x * std::sin(rod.angle) - y * std::cos(rod.angle);
  const double beyond = along - std::clamp(along, 0.0, rod.length);  // of the nearer end
  const double across = x * std::cos(rod.angle) + y * std::sin(rod.angle);
  return std::clamp((0.1 - std::hypot(beyond, across)) / 0.2 + 0.5, 0.0, 1.0);
}

TEST(RodRenderer, RoundsTheGreyValueOfThePublishedFormulaForTheNearestRod) {
  // Tilted, so that the grey values are no round numbers.
  const Rod first{Eigen::Vector2d::Zero(), 0.3, 1.0};
  const Rod second{first.end(), -2.0, 0.5};
  const Rod apart{{-0.8, 0.7}, -1.0, 0.2};
  for (const std::vector<Rod>& rods :
       {std::vector<Rod>{first}, {first, second, apart}, {apart, second, first}}) {
    const std::vector<std::uint8_t> image = RodRenderer(kSize, RodLook()).render(rods).bytes;
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j < kSize; ++j) {
        double grey = 0.0;
        for (const Rod& rod : rods) grey = std::max(grey, greyOf(rod, i, j));
        ASSERT_NEAR(image[i * kSize + j], 255 * grey, 0.5 + 1e-9) << i << ", " << j;
      }
    }
  }
}

}  // namespace
}  // namespace ddm
