// Tests of the rod renderer: content of the image, motion, symmetry and grey values.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/rod_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ddm_sim/angles.h"

namespace ddm {
namespace {

constexpr int kSize = 51;

using Bytes = std::vector<std::uint8_t>;

/// A rod of 1 m that begins in the middle of the image.
Rod rodAt(double angle) { return {Eigen::Vector2d::Zero(), angle, 1.0}; }

Bytes render(double angle) { return RodRenderer(kSize, RodLook()).render({rodAt(angle)}).bytes; }

TEST(RodRenderer, ChangesTheImageWithinOneDegree) {
  for (int degree = 0; degree < 360; ++degree) {
    ASSERT_NE(render(degree * kPi / 180), render((degree + 1) * kPi / 180)) << degree;
  }
}

TEST(RodRenderer, MirrorsTheImageForTheOppositeAngle) {
  for (const double angle : {0.0, 0.3, 1.0, 2.5, kPi}) {
    Bytes mirrored = render(-angle);
    for (int i = 0; i < kSize; ++i) {
      std::reverse(mirrored.begin() + i * kSize, mirrored.begin() + (i + 1) * kSize);
    }
    EXPECT_EQ(render(angle), mirrored) << angle;
  }
}

TEST(RodRenderer, RoundsTheGreyValueOfThePublishedFormula) {
  const double angle = 0.3;  // tilted, so that the grey values are no round numbers
  const Bytes image = render(angle);
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      const double x = (j - 25) * 2.4 / kSize;
      const double y = (25 - i) * 2.4 / kSize;
      const double along = x * std::sin(angle) - y * std::cos(angle);
      const double beyond = along - std::clamp(along, 0.0, 1.0);  // distance beyond the nearer end
      const double across = x * std::cos(angle) + y * std::sin(angle);
      const double grey = std::clamp((0.1 - std::hypot(beyond, across)) / 0.2 + 0.5, 0.0, 1.0);
      ASSERT_NEAR(image[i * kSize + j], 255 * grey, 0.5 + 1e-9) << "row " << i << ", column " << j;
    }
  }
}

TEST(RodRenderer, ShowsTheNearestOfSeveralRodsInEachPixel) {
  const RodRenderer renderer(kSize, RodLook());
  const Rod first = rodAt(0.4);
  const Rod second{first.end(), 2.0, 0.5};
  const Rod apart{{-0.8, 0.7}, -1.0, 0.2};
  const Bytes all = renderer.render({first, second, apart}).bytes;
  const Bytes one = renderer.render({first}).bytes;
  const Bytes two = renderer.render({second}).bytes;
  const Bytes three = renderer.render({apart}).bytes;
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_EQ(all[i], std::max({one[i], two[i], three[i]})) << i;
  }
  EXPECT_EQ(renderer.render({apart, second, first}).bytes, all);
}

TEST(RodRenderer, StartsARodWhereItSays) {
  constexpr int kShift = 7;  // [pixels]
  const double pixel = 2.4 / kSize;
  const RodRenderer renderer(kSize, RodLook());
  const Bytes middle = renderer.render({{Eigen::Vector2d::Zero(), 0.6, 0.5}}).bytes;
  const Bytes moved = renderer.render({{{kShift * pixel, 2 * pixel}, 0.6, 0.5}}).bytes;
  for (int i = 0; i < kSize - 2; ++i) {
    for (int j = 0; j < kSize - kShift; ++j) {  // shifted to the right, and two rows up
      ASSERT_NEAR(moved[i * kSize + j + kShift], middle[(i + 2) * kSize + j], 1) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace ddm
