// Tests of the rod renderer: what the image shows, how it moves, its symmetry and grey values.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/rod_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace ddm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kSize = 51;

using Bytes = std::vector<std::uint8_t>;

Bytes render(double angle) { return RodRenderer(CameraOptions(), 1.0).render(angle); }

int brightness(const Bytes& image, int row_begin, int row_end, int column_begin, int column_end) {
  int sum = 0;
  for (int i = row_begin; i < row_end; ++i) {
    for (int j = column_begin; j < column_end; ++j) sum += image[i * kSize + j];
  }
  return sum;
}

TEST(RodRenderer, ShowsTheHangingRodInTheLowerHalf) {
  const Bytes image = render(0.0);
  EXPECT_GT(brightness(image, 26, 51, 0, 51), 5 * brightness(image, 0, 25, 0, 51));
}

TEST(RodRenderer, ShowsTheGoalInTheUpperHalf) {
  const Bytes image = render(kPi);
  EXPECT_GT(brightness(image, 0, 25, 0, 51), 5 * brightness(image, 26, 51, 0, 51));
}

TEST(RodRenderer, TurnsCounterClockwiseForAPositiveAngle) {
  const Bytes image = render(kPi / 2);  // from hanging by a quarter turn: points right
  EXPECT_GT(brightness(image, 0, 51, 26, 51), 5 * brightness(image, 0, 51, 0, 25));
}

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

TEST(RodRenderer, KeepsItsBrightnessWhileItTurns) {
  // The area of the rod in pixels times 255: a stadium of length 1 and half-width 0.1 whose edge
  // blurs over +-0.1, so area = 2 * 0.1 * 1 + integral of 2 pi r grey(r) / 2 at each of the two
  // ends.
  const double ends = 2 * kPi * (0.2 * 0.2 / 2 - 0.2 * 0.2 / 3);  // grey(r) = 1 - r / 0.2
  const double pixel = 2.4 / kSize;
  const double expected = 255 * (0.2 + ends) / (pixel * pixel);
  for (int degree = 0; degree < 360; degree += 7) {
    const double sum = brightness(render(degree * kPi / 180), 0, kSize, 0, kSize);
    EXPECT_NEAR(sum / expected, 1.0, 0.02) << degree;
  }
}

TEST(RodRenderer, IsWhiteOnTheRodAndBlackFarFromIt) {
  const Bytes image = render(0.0);
  EXPECT_EQ(image[25 * kSize + 25], 255);  // the pivot, at distance 0
  EXPECT_EQ(image[0], 0);
  EXPECT_EQ(image[50 * kSize + 50], 0);
}

TEST(RodRenderer, RoundsTheGreyValueOfThePublishedFormula) {
  const double angle = 0.3;  // tilted, so that the grey values are no round numbers
  const Bytes image = render(angle);
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      const double x = (j - 25) * 2.4 / kSize;
      const double y = (25 - i) * 2.4 / kSize;
      const double along = x * std::sin(angle) - y * std::cos(angle);
      const double beyond = along - std::clamp(along, 0.0, 1.0);  // of the nearer end
      const double across = x * std::cos(angle) + y * std::sin(angle);
      const double grey = std::clamp((0.1 - std::hypot(beyond, across)) / 0.2 + 0.5, 0.0, 1.0);
      ASSERT_NEAR(image[i * kSize + j], 255 * grey, 0.5 + 1e-9) << "row " << i << ", column " << j;
    }
  }
}

TEST(RodRenderer, HasTheSizeAndExtentOfItsOptions) {
  CameraOptions options;
  options.size = 20;
  options.half_extent = 4.0;
  const Bytes small = RodRenderer(options, 1.0).render(0.0);
  EXPECT_EQ(small.size(), 400U);
  // The tip stands at a quarter of the half height: rows below 10 + 2.5 + softness are black.
  EXPECT_EQ(std::accumulate(small.begin() + 14 * 20, small.end(), 0), 0);
}

TEST(RodRenderer, RefusesInvalidOptionsAndLengths) {
  CameraOptions options;
  options.edge_softness = 0.0;
  EXPECT_THROW(RodRenderer(options, 1.0), std::invalid_argument);
  EXPECT_THROW(RodRenderer(CameraOptions(), 0.0), std::invalid_argument);
  EXPECT_THROW(RodRenderer(CameraOptions(), std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
}

}  // namespace
}  // namespace ddm
