// Tests of the moving tile: its image, the reflection at the border, initial state and goal.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/moving_tile.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace ddm {
namespace {

constexpr int kTileImage = 51;
constexpr double kLowest = 4.5;
constexpr double kHighest = 46.5;

/// One step of a tile with unlimited increments.
Eigen::VectorXd stepOf(const Eigen::Vector2d& state, const Eigen::Vector2d& increment) {
  MovingTileOptions options;
  options.max_torque = {1e300};
  MovingTile tile(options);
  tile.setState(state);
  tile.step(increment);
  return tile.state();
}

TEST(MovingTile, MovesByTheIncrementAndBouncesOffTheBorder) {
  EXPECT_EQ(stepOf({25.0, 30.0}, {3.0, -4.5}), Eigen::Vector2d(28.0, 25.5));
  EXPECT_EQ(stepOf({0.1 + 20, 20.0}, {0.2, 0.0})[0], 0.1 + 20 + 0.2);  // exactly, without rounding
  EXPECT_EQ(stepOf({10.0, 10.0}, {kLowest - 10, kHighest - 10}),
            Eigen::Vector2d(kLowest, kHighest));
  EXPECT_EQ(stepOf({46.0, 5.0}, {2.0, -3.0}), Eigen::Vector2d(45.0, 7.0));
  EXPECT_EQ(stepOf({46.0, 5.0}, {44.0, -44.0}), Eigen::Vector2d(6.0, 45.0));  // twice each
}

TEST(MovingTile, StaysInsideWhateverPushesItFromWherever) {
  for (const double far : {0.0, 1e10, 1e17, 1e300, 1.7e308}) {
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::VectorXd next = stepOf({sign * far, 25.0}, {0.0, sign * std::min(far, 1e300)});
      EXPECT_GE(next.minCoeff(), kLowest) << sign * far;
      EXPECT_LE(next.maxCoeff(), kHighest) << sign * far;
    }
  }
}

TEST(MovingTile, StartsInTheMiddleAndHasItsGoalUpAndToTheRightWithinItsReach) {
  MovingTileOptions options;
  const MovingTile tile(options);
  EXPECT_EQ(tile.state(), Eigen::Vector2d(25.5, 25.5));
  EXPECT_EQ(tile.goal(), Eigen::Vector2d(38.25, 12.75));
  EXPECT_EQ(tile.goalError(Eigen::Vector2d(38.25 - 3.0, 12.75 + 4.0)), 5.0);
  options.image_size = 12;
  EXPECT_EQ(MovingTile(options).goal(), Eigen::Vector2d(7.5, 4.5));
  EXPECT_EQ(MovingTile(options).render(Eigen::Vector2d(6.0, 6.0)).bytes.size(), 144U);
}

TEST(MovingTile, RefusesAnImageWithoutRoomForTheTileAndAllOtherProblemsWithIt) {
  MovingTileOptions options;
  options.dt = -1.0;
  options.image_size = 9;
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>([&] { MovingTile tile(options); },
                                                           {"plant/image_size", "plant/dt"}));
}

/// The grey value of a pixel by the formula in the header.
double greyOf(int row, int column, double x, double y) {
  const auto covered = [](double d) {
    const double low = std::max(d + 0.5 - kTileSoftness / 2, -kTileWidth / 2);
    const double high = std::min(d + 0.5 + kTileSoftness / 2, kTileWidth / 2);
    return std::max(0.0, high - low) / kTileSoftness;
  };
  return covered(row - y) * covered(column - x);
}

TEST(DrawTile, RoundsTheGreyOfItsFormulaInsideAndAtTheBorder) {
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(20.5, 10.5), Eigen::Vector2d(23.37, 7.81),
                                    Eigen::Vector2d(4.5, 46.5), Eigen::Vector2d(51.0, 0.0)}) {
    const RenderedImage rendered = drawTile(kTileImage, at);
    EXPECT_EQ(rendered.cover, rendered.bytes);
    for (int i = 0; i < kTileImage; ++i) {
      for (int j = 0; j < kTileImage; ++j) {
        const int grey = rendered.bytes[static_cast<std::size_t>(i * kTileImage + j)];
        ASSERT_NEAR(grey, 255 * greyOf(i, j, at.x(), at.y()), 0.5 + 1e-9) << i << ", " << j;
      }
    }
  }
}

TEST(DrawTile, IsBlackWhereTheTileIsFarOutside) {
  const std::vector<std::uint8_t> black(kTileImage * kTileImage, 0);
  for (const double far : {-9.0, 60.0, -1e17, std::numeric_limits<double>::max()}) {
    EXPECT_EQ(drawTile(kTileImage, {far, 25.5}).bytes, black) << far;
    EXPECT_EQ(drawTile(kTileImage, {25.5, far}).bytes, black) << far;
  }
}

}  // namespace
}  // namespace ddm
