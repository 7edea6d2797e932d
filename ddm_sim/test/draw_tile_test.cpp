// Tests of the picture of a tile: coverage of each pixel, shifts, edges and what is cut off.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "ddm_sim/moving_tile.h"

namespace ddm {
namespace {

constexpr int kPictureSize = 51;

using Bytes = std::vector<std::uint8_t>;

/// A tile as sharp as pixels allow.
Bytes render(double x, double y, double width = 9.0) {
  return drawTile(kPictureSize, width, 1.0, {x, y}).bytes;
}

Bytes renderSoft(double x, double y, double softness) {
  return drawTile(kPictureSize, 9.0, softness, {x, y}).bytes;
}

int at(const Bytes& image, int row, int column) { return image[row * kPictureSize + column]; }

double sum(const Bytes& image) { return std::accumulate(image.begin(), image.end(), 0.0); }

/// Bounding box of all that is not black: first and last row, first and last column.
std::vector<int> box(const Bytes& image) {
  std::vector<int> out{kPictureSize, -1, kPictureSize, -1};
  for (int i = 0; i < kPictureSize; ++i) {
    for (int j = 0; j < kPictureSize; ++j) {
      if (at(image, i, j) == 0) continue;
      out = {std::min(out[0], i), std::max(out[1], i), std::min(out[2], j), std::max(out[3], j)};
    }
  }
  return out;
}

TEST(DrawTile, DrawsAWhiteSquareOnBlackWhereItsEdgesFallBetweenPixels) {
  const Bytes image = render(20.5, 10.5);  // [16, 25] x [6, 15]
  for (int i = 0; i < kPictureSize; ++i) {
    for (int j = 0; j < kPictureSize; ++j) {
      const bool inside = i >= 6 && i < 15 && j >= 16 && j < 25;
      ASSERT_EQ(at(image, i, j), inside ? 255 : 0) << "row " << i << ", column " << j;
    }
  }
}

TEST(DrawTile, GivesAllItsAreaToThePictureAtEveryPositionInside) {
  std::mt19937_64 engine(1);
  for (const double width : {0.3, 1.0, 2.5, 9.0, 20.7}) {
    std::uniform_real_distribution<double> inside(width / 2, kPictureSize - width / 2);
    for (int i = 0; i < 200; ++i) {
      const Bytes image = render(inside(engine), inside(engine), width);
      // Only pixels at the edge are rounded, each by half a grey level at most.
      const auto grey = [](std::uint8_t k) { return k != 0 && k != 255; };
      const auto num_grey = std::count_if(image.begin(), image.end(), grey);
      ASSERT_NEAR(sum(image), 255 * width * width, 0.5 * (num_grey + 1)) << width;
    }
  }
}

TEST(DrawTile, RoundsTheAreaOfThePixelThatTheTileCovers) {
  // The area, counted on a grid of points. The tile's edges are multiples of a hundredth of a
  // pixel, so the count is exact.
  const double x = 23.37;
  const double y = 7.81;
  const double half = 4.5;
  const Bytes image = render(x, y);
  constexpr int kPoints = 100;  // along each side of a pixel
  for (int i = 0; i < 16; ++i) {
    for (int j = 16; j < 32; ++j) {
      int covered = 0;
      for (int p = 0; p < kPoints; ++p) {
        for (int q = 0; q < kPoints; ++q) {
          const double dy = i + (p + 0.5) / kPoints - y;
          const double dx = j + (q + 0.5) / kPoints - x;
          if (std::abs(dx) < half && std::abs(dy) < half) ++covered;
        }
      }
      const double grey = static_cast<double>(covered) / (kPoints * kPoints);
      ASSERT_NEAR(at(image, i, j), 255 * grey, 0.5 + 1e-9) << i << ", " << j;
    }
  }
}

TEST(DrawTile, ShiftsThePictureWithTheTileByWholePixels) {
  const double x = 20.25;  // dyadic fractions: shifting them by whole numbers rounds nothing
  const double y = 18.6875;
  const Bytes image = render(x, y);
  for (const auto& [right, down] : std::vector<std::pair<int, int>>{{1, 0}, {0, 1}, {-7, 12}}) {
    const Bytes shifted = render(x + right, y + down);
    for (int i = 12; i < kPictureSize; ++i) {
      for (int j = 7; j < kPictureSize - 7; ++j) {
        ASSERT_EQ(at(shifted, i, j), at(image, i - down, j - right)) << right << ", " << down;
      }
    }
    EXPECT_EQ(sum(shifted), sum(image));
  }
}

TEST(DrawTile, ShowsHalfGreyEdgesAtHalfAPixel) {
  const Bytes image = render(20.0, 10.0);  // [15.5, 24.5] x [5.5, 14.5]
  EXPECT_EQ(box(image), (std::vector<int>{5, 14, 15, 24}));
  for (int k = 6; k < 14; ++k) {
    EXPECT_EQ(at(image, k, 15), 128);  // round(127.5)
    EXPECT_EQ(at(image, k, 24), 128);
    EXPECT_EQ(at(image, 5, k + 10), 128);
    EXPECT_EQ(at(image, 14, k + 10), 128);
    EXPECT_EQ(at(image, k, 20), 255);
  }
  EXPECT_EQ(at(image, 5, 15), 64);  // a quarter at the corner: round(63.75)
}

TEST(DrawTile, FallsFromWhiteToBlackOverItsSoftness) {
  const Bytes image =
      renderSoft(20.5, 20.5, 4.0);  // edges at 16 and 25, from 14 to 18 and 23 to 27
  EXPECT_EQ(box(image), (std::vector<int>{14, 26, 14, 26}));
  const int expected[] = {0, 32, 96, 159, 223, 255};  // round(255 (d + 1/2) / 4)
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(at(image, 20, 13 + k), expected[k]) << k;
    EXPECT_EQ(at(image, 20, 27 - k), expected[k]) << k;
    EXPECT_EQ(at(image, 13 + k, 20), expected[k]) << k;
  }
  EXPECT_EQ(at(image, 14, 14), 4);  // round(255 / 64): both edges at the corner
}

TEST(DrawTile, IsTheMeanOfShiftedSharpTilesWhereSoft) {
  // A window of three pixels around the centre is the mean of three pixels side by side.
  const Bytes soft = renderSoft(20.3, 18.7, 3.0);
  const Bytes sharp = render(20.3, 18.7);
  for (int i = 8; i < 30; ++i) {
    for (int j = 8; j < 32; ++j) {
      double mean = 0.0;
      for (int p = -1; p <= 1; ++p) {
        for (int q = -1; q <= 1; ++q) mean += at(sharp, i + p, j + q) / 9.0;
      }
      ASSERT_NEAR(at(soft, i, j), mean, 1.0) << i << ", " << j;
    }
  }
}

TEST(DrawTile, KeepsTheAreaOfATileThatIsNarrowerThanItsEdges) {
  const Bytes image = drawTile(kPictureSize, 2.0, 6.0, {25.5, 25.5}).bytes;
  EXPECT_NEAR(sum(image), 255 * 4.0, 0.5 * 49);
  EXPECT_EQ(at(image, 25, 25), 28);  // 255 / 9
}

TEST(DrawTile, MovesRightForALargerXAndDownForALargerY) {
  EXPECT_EQ(box(render(4.5, 46.5)), (std::vector<int>{42, 50, 0, 8}));  // lower left corner
  EXPECT_EQ(box(render(46.5, 4.5)), (std::vector<int>{0, 8, 42, 50}));  // upper right corner
}

TEST(DrawTile, CutsOffWhatLiesOutside) {
  EXPECT_EQ(sum(render(0.0, 25.5)), 255 * 4.5 * 9 + 0.5 * 9);  // 9 pixels of 127.5, rounded up
  EXPECT_EQ(sum(render(51.0, 51.0, 8.0)), 255 * 16);
  for (const double far : {-4.5, 55.5, 1e3, -1e17, 1e300, std::numeric_limits<double>::max()}) {
    EXPECT_EQ(sum(render(far, 25.5)), 0.0) << far;
    EXPECT_EQ(sum(render(25.5, far)), 0.0) << far;
  }
}

TEST(DrawTile, FillsThePictureWithATileLargerThanIt) {
  EXPECT_EQ(sum(render(25.5, 25.5, 1e3)), 255.0 * kPictureSize * kPictureSize);
}

TEST(DrawTile, ChangesTheImageWithinATenthOfAPixel) {
  for (int tenth = 0; tenth < 420; ++tenth) {
    const double x = 4.5 + 0.1 * tenth;
    ASSERT_NE(render(x, 20.0), render(x + 0.1, 20.0)) << x;
    ASSERT_NE(render(20.0, x), render(20.0, x + 0.1)) << x;
  }
}

TEST(DrawTile, HasTheSizeOfItsPicture) {
  const Picture picture = drawTile(20, 3.0, 1.0, {10.0, 10.0});
  EXPECT_EQ(picture.width, 20);
  EXPECT_EQ(picture.height, 20);
  EXPECT_EQ(picture.channels, 1);
  EXPECT_EQ(picture.bytes.size(), 400U);
  EXPECT_EQ(picture.cover, picture.bytes);
}

}  // namespace
}  // namespace ddm
