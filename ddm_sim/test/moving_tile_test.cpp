// Tests of the moving tile: reflection at the border, saturation, start, goal and position.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/moving_tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

namespace ddm {
namespace {

constexpr double kLowest = 4.5;
constexpr double kHighest = 46.5;

MovingTileOptions tileOptions() {
  MovingTileOptions options;
  options.max_torque = {5.0};
  options.start_std = {5.0};
  return options;
}

/// One step of a tile that may be pushed by any distance.
Eigen::VectorXd stepOf(const Eigen::Vector2d& state, const Eigen::Vector2d& increment) {
  MovingTileOptions options = tileOptions();
  options.max_torque = {1e300};
  MovingTile tile(options);
  tile.setState(state);
  tile.step(increment);
  return tile.state();
}

/// The reflected position, bounce by bounce, independent of the code under test.
double bounced(double position) {
  while (position < kLowest || position > kHighest) {
    if (position > kHighest) position = 2 * kHighest - position;
    if (position < kLowest) position = 2 * kLowest - position;
  }
  return position;
}

TEST(MovingTile, MovesByTheIncrementWhereverItFits) {
  EXPECT_EQ(stepOf({25.0, 30.0}, {3.0, -4.5}), Eigen::Vector2d(28.0, 25.5));
  EXPECT_EQ(stepOf({0.1 + 20, 20.0}, {0.2, 0.0})[0], 0.1 + 20 + 0.2);  // digit by digit
  EXPECT_EQ(stepOf({10.0, 10.0}, {kLowest - 10, kHighest - 10}),
            Eigen::Vector2d(kLowest, kHighest));
}

TEST(MovingTile, BouncesOffTheBorder) {
  EXPECT_EQ(stepOf({46.0, 20.0}, {2.0, 0.0}), Eigen::Vector2d(45.0, 20.0));
  EXPECT_EQ(stepOf({20.0, 5.0}, {0.0, -3.0}), Eigen::Vector2d(20.0, 7.0));
  EXPECT_EQ(stepOf({46.0, 5.0}, {2.0, -3.0}), Eigen::Vector2d(45.0, 7.0));
}

TEST(MovingTile, BouncesAsOftenAsTheIncrementTakesIt) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> start(kLowest, kHighest);
  for (const double reach : {5.0, 60.0, 1e3, 1e4}) {
    std::uniform_real_distribution<double> increment(-reach, reach);
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector2d state(start(engine), start(engine));
      const Eigen::Vector2d push(increment(engine), increment(engine));
      const Eigen::VectorXd next = stepOf(state, push);
      ASSERT_NEAR(next[0], bounced(state[0] + push[0]), 1e-8 * reach / 1e3 + 1e-12);
      ASSERT_NEAR(next[1], bounced(state[1] + push[1]), 1e-8 * reach / 1e3 + 1e-12);
    }
  }
}

TEST(MovingTile, StaysInsideWhateverPushesItFromWherever) {
  for (const double far : {1e10, 1e17, 1e300, 1.7e308}) {
    for (const double sign : {-1.0, 1.0}) {
      const Eigen::VectorXd next = stepOf({sign * far, 25.0}, {0.0, sign * std::min(far, 1e300)});
      EXPECT_GE(next.minCoeff(), kLowest) << sign * far;
      EXPECT_LE(next.maxCoeff(), kHighest) << sign * far;
    }
  }
}

TEST(MovingTile, StaysWhollyInsideUnderTenThousandRandomIncrements) {
  for (const double width : {9.0, 0.7, 40.3, 50.9}) {
    MovingTileOptions options = tileOptions();
    options.tile_width = width;
    options.tile_softness = 1.0;  // soft edges reach beyond the border
    MovingTile tile(options);
    std::mt19937_64 engine(2);
    std::uniform_real_distribution<double> increment(-5.0, 5.0);
    double least = 51.0;
    double greatest = 0.0;
    for (int i = 0; i < 10000; ++i) {
      tile.step(Eigen::Vector2d(increment(engine), increment(engine)));
      least = std::min(least, tile.state().minCoeff());
      greatest = std::max(greatest, tile.state().maxCoeff());
      const std::vector<std::uint8_t> grey = tile.render(tile.state()).bytes;
      const double sum = std::accumulate(grey.begin(), grey.end(), 0.0);
      ASSERT_NEAR(sum, 255 * width * width, 0.5 * (4 * width + 8)) << "step " << i;
    }
    EXPECT_GE(least, width / 2);
    EXPECT_LE(greatest, 51 - width / 2);
    const double room = 51 - width;
    EXPECT_LT(least, width / 2 + 0.05 * room);  // and it does reach the border
    EXPECT_GT(greatest, 51 - width / 2 - 0.05 * room);
  }
}

TEST(MovingTile, IsNeverRoundedBeyondTheBorderWhateverItsWidth) {
  for (int tenths = 1; tenths < 510; ++tenths) {
    MovingTileOptions options = tileOptions();
    options.tile_width = tenths / 10.0;
    const double lowest = options.tile_width / 2;
    const double highest = 51 - options.tile_width / 2;
    MovingTile tile(options);
    const double room = highest - lowest;
    // All of these are the greatest coordinate after folding, but for what rounding adds to it.
    for (const double position : {highest, lowest - room, highest + 2 * room}) {
      tile.setState(Eigen::Vector2d::Constant(position));
      tile.step(Eigen::Vector2d::Zero());
      ASSERT_LE(tile.state().maxCoeff(), highest) << options.tile_width;
      ASSERT_NEAR(tile.state().minCoeff(), highest, 1e-13) << options.tile_width;
    }
  }
}

TEST(MovingTile, SaturatesEachIncrementByItself) {
  MovingTile tile(tileOptions());
  EXPECT_EQ(tile.step(Eigen::Vector2d(100.0, -5.5)), Eigen::Vector2d(5.0, -5.0));
  EXPECT_EQ(tile.state(), Eigen::Vector2d(30.5, 20.5));
  EXPECT_EQ(tile.step(Eigen::Vector2d(-4.75, 5.0)), Eigen::Vector2d(-4.75, 5.0));
  EXPECT_EQ(tile.state(), Eigen::Vector2d(25.75, 25.5));
}

TEST(MovingTile, ReportsTheIncrementBeforeTheBounce) {
  MovingTile tile(tileOptions());
  tile.setState(Eigen::Vector2d(46.0, 25.0));
  EXPECT_EQ(tile.step(Eigen::Vector2d(4.0, 0.0)), Eigen::Vector2d(4.0, 0.0));
  EXPECT_EQ(tile.state(), Eigen::Vector2d(43.0, 25.0));
}

TEST(MovingTile, RefusesAnIncrementOfOneNumber) {
  MovingTile tile(tileOptions());
  EXPECT_THROW(tile.step(Eigen::VectorXd::Zero(1)), std::invalid_argument);
  EXPECT_EQ(tile.state(), Eigen::Vector2d(25.5, 25.5));
}

TEST(MovingTile, StartsAroundTheMiddleOfThePicture) {
  const MovingTile tile(tileOptions());
  EXPECT_EQ(tile.state(), Eigen::Vector2d(25.5, 25.5));
  std::mt19937_64 engine = startStream(1, 0, false);
  constexpr int kDraws = 20000;
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  Eigen::Array2d sum_of_squares = Eigen::Array2d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Array2d offset = tile.drawStart(engine).array() - 25.5;
    sum += offset;
    sum_of_squares += offset.square();
  }
  // Five standard errors: 5 / sqrt(n) of the mean, 5 / sqrt(2 n) of the deviation.
  EXPECT_LT((sum / kDraws).abs().maxCoeff(), 5 * 5 / std::sqrt(kDraws));
  EXPECT_LT(((sum_of_squares / kDraws).sqrt() - 5).abs().maxCoeff(),
            5 * 5 / std::sqrt(2.0 * kDraws));
}

TEST(MovingTile, ShowsAndBringsBackAStartFarOutside) {
  MovingTileOptions options = tileOptions();
  options.start_std = {1e6};
  MovingTile tile(options);
  std::mt19937_64 engine = startStream(1, 0, false);
  tile.setState(tile.drawStart(engine));
  ASSERT_GT((tile.state().array() - 25.5).abs().maxCoeff(), 1e3);
  EXPECT_EQ(tile.render(tile.state()).bytes, std::vector<std::uint8_t>(51 * 51, 0));
  tile.step(Eigen::Vector2d::Zero());
  EXPECT_GE(tile.state().minCoeff(), kLowest);
  EXPECT_LE(tile.state().maxCoeff(), kHighest);
}

TEST(MovingTile, HasItsGoalUpAndToTheRightAndMeasuresTheDistanceInPixels) {
  const MovingTile tile(tileOptions());
  EXPECT_EQ(tile.goal(), Eigen::Vector2d(38.25, 12.75));
  EXPECT_EQ(tile.goalError(tile.goal()), 0.0);
  EXPECT_EQ(tile.goalError(Eigen::Vector2d(38.25 - 3.0, 12.75 + 4.0)), 5.0);
  EXPECT_EQ(tile.info().error_unit, "px");
  EXPECT_EQ(tile.info().tolerance, 2.0);
}

TEST(MovingTile, HasItsGoalWithinItsReachWhereTheTileIsLarge) {
  MovingTileOptions options = tileOptions();
  options.tile_width = 41.0;
  const MovingTile tile(options);
  EXPECT_EQ(tile.goal(), Eigen::Vector2d(30.5, 20.5));
}

TEST(MovingTile, IsSeenWhereItsCentreIs) {
  const MovingTile tile(tileOptions());
  const Eigen::Vector2d state(17.25, 31.5);
  EXPECT_EQ(tile.visiblePosition(state), state);
  // The centre of brightness in the picture is there too; pixel j has its centre at j + 1/2.
  const std::vector<std::uint8_t> grey = tile.render(state).bytes;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0.0;
  for (int i = 0; i < 51; ++i) {
    for (int j = 0; j < 51; ++j) {
      sum += grey[i * 51 + j] * Eigen::Vector2d(j + 0.5, i + 0.5);
      total += grey[i * 51 + j];
    }
  }
  EXPECT_LT((sum / total - state).norm(), 0.02);
}

TEST(MovingTile, NamesItsStateAndTorquesWithTheirUnitsAndHasNoRates) {
  const PlantInfo info = MovingTile(tileOptions()).info();
  EXPECT_EQ(info.state_names, (std::vector<std::string>{"x_px", "y_px"}));
  EXPECT_EQ(info.torque_names, (std::vector<std::string>{"dx_px", "dy_px"}));
  ASSERT_EQ(info.joints.size(), 2U);
  EXPECT_EQ(info.joints[0].name, "x");
  EXPECT_EQ(info.joints[1].name, "y");
  EXPECT_EQ(info.joints[0].kind, JointKind::kLength);
  EXPECT_EQ(info.joints[1].kind, JointKind::kLength);
}

TEST(MovingTile, TakesALimitAndASpreadForEachDirection) {
  MovingTileOptions options;
  options.max_torque = {3.0, 4.0};
  options.start_std = {0.0, 2.0};
  MovingTile tile(options);
  EXPECT_EQ(tile.info().start_std, Eigen::Vector2d(0.0, 2.0));
  EXPECT_EQ(tile.step(Eigen::Vector2d(9.0, -9.0)), Eigen::Vector2d(3.0, -4.0));
}

TEST(MovingTile, FitsAPictureOfAnotherSize) {
  MovingTileOptions options = tileOptions();
  options.picture_size = 20;
  const MovingTile tile(options);
  EXPECT_EQ(tile.state(), Eigen::Vector2d(10.0, 10.0));
  EXPECT_EQ(tile.goal(), Eigen::Vector2d(15.0, 5.0));
  const Picture picture = tile.render(tile.state());
  EXPECT_EQ(picture.width, 20);
  EXPECT_EQ(picture.height, 20);
  EXPECT_EQ(picture.channels, 1);
  EXPECT_EQ(picture.bytes.size(), 400U);
}

TEST(MovingTile, RefusesATileThatHasNoRoomInThePictureAndAllOtherProblemsWithIt) {
  MovingTileOptions options = tileOptions();
  options.dt = -1.0;
  options.picture_size = 9;
  options.tile_softness = 0.5;
  try {
    MovingTile tile(options);
    FAIL() << "a tile without room was made";
  } catch (const std::invalid_argument& e) {
    const std::string message = e.what();
    for (const char* part :
         {"plant/tile_width", "plant/picture_size (9)", "plant/tile_softness", "plant/dt"}) {
      EXPECT_NE(message.find(part), std::string::npos) << message;
    }
  }
  options = tileOptions();
  options.picture_size = 9;
  options.tile_width = 8.9;
  EXPECT_NO_THROW(MovingTile{options});
}

}  // namespace
}  // namespace ddm
