// Tests of what all plants share: checks, saturation, start states and their random stream.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "ddm_sim/plant_factory.h"

namespace ddm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::unique_ptr<Plant> pendulum() { return makePlant(PlantOptions(), CameraOptions()); }

Eigen::VectorXd torque(double value) { return Eigen::VectorXd::Constant(1, value); }

TEST(Plant, StartsAtRestInTheMiddleOfItsStartStates) {
  EXPECT_EQ(pendulum()->state(), Eigen::Vector2d::Zero());
}

TEST(Plant, TakesAStateDigitByDigit) {
  const auto plant = pendulum();
  const Eigen::Vector2d state(0.1 + 0.2, -1e-17);
  plant->setState(state);
  EXPECT_EQ(plant->state(), state);
}

TEST(Plant, RefusesAStateOfAnotherSizeOrNotFiniteAndKeepsTheOldOne) {
  const auto plant = pendulum();
  plant->setState(Eigen::Vector2d(1.0, 2.0));
  EXPECT_THROW(plant->setState(Eigen::VectorXd::Zero(0)), std::invalid_argument);
  EXPECT_THROW(plant->setState(Eigen::VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_THROW(plant->setState(Eigen::Vector2d(0.0, kNaN)), std::invalid_argument);
  EXPECT_THROW(plant->setState(Eigen::Vector2d(kInfinity, 0.0)), std::invalid_argument);
  EXPECT_EQ(plant->state(), Eigen::Vector2d(1.0, 2.0));
}

TEST(Plant, NamesTheFirstOfManyNumbers) {
  const auto plant = pendulum();
  try {
    plant->setState(Eigen::VectorXd::LinSpaced(1000000, 1.0, 1000000.0));
    FAIL() << "taken";
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(),
                 "plant: the state must be 2 finite number(s), got "
                 "[ 1  2  3  4  5  6  7  8  9 10 ..., 1000000 in all]");
  }
}

TEST(Plant, RefusesATorqueOfAnotherSizeOrNotFiniteAndDoesNotMove) {
  const auto plant = pendulum();
  EXPECT_THROW(plant->step(Eigen::VectorXd::Zero(0)), std::invalid_argument);
  EXPECT_THROW(plant->step(Eigen::VectorXd::Zero(2)), std::invalid_argument);
  EXPECT_THROW(plant->step(torque(kNaN)), std::invalid_argument);
  EXPECT_THROW(plant->step(torque(-kInfinity)), std::invalid_argument);
  EXPECT_EQ(plant->state(), Eigen::Vector2d::Zero());
}

TEST(Plant, NamesTheValueItRefuses) {
  try {
    pendulum()->setState(Eigen::Vector3d(7.0, 8.0, 9.0));
    FAIL() << "three numbers were taken for a state";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("[7 8 9]"), std::string::npos) << e.what();
  }
}

TEST(Plant, SaturatesATorqueBeyondTheLimitAndSaysWhatItApplied) {
  for (const double sign : {-1.0, 1.0}) {
    const auto limited = pendulum();
    const auto at_limit = pendulum();
    EXPECT_EQ(limited->step(torque(sign * 1e9))[0], sign * 6.0);
    EXPECT_EQ(at_limit->step(torque(sign * 6.0))[0], sign * 6.0);
    EXPECT_EQ(limited->state(), at_limit->state());
  }
  EXPECT_EQ(pendulum()->step(torque(5.5))[0], 5.5);
}

TEST(Plant, ReportsAStateThatLeavesTheRangeOfDoubleAndDoesNotMove) {
  const auto plant = pendulum();
  const Eigen::Vector2d state(1.7e308, 1.7e308);
  plant->setState(state);
  EXPECT_THROW(plant->step(torque(0.0)), std::range_error);
  EXPECT_EQ(plant->state(), state);
}

TEST(Plant, RefusesToRenderOrJudgeAStateThatIsNotFinite) {
  const auto plant = pendulum();
  EXPECT_THROW(plant->render(Eigen::Vector2d(kNaN, 0.0)), std::invalid_argument);
  EXPECT_THROW(plant->goalError(Eigen::Vector2d(kNaN, 0.0)), std::invalid_argument);
  EXPECT_THROW(plant->goalError(Eigen::VectorXd::Zero(1)), std::invalid_argument);
}

TEST(Plant, RefusesToLocateAStateOfAnotherSizeOrNotFinite) {
  const auto plant = pendulum();
  EXPECT_THROW(plant->visiblePosition(Eigen::Vector2d(kNaN, 0.0)), std::invalid_argument);
  EXPECT_THROW(plant->visiblePosition(Eigen::VectorXd::Zero(1)), std::invalid_argument);
}

TEST(Plant, HasAsManyNamesAsComponents) {
  for (const std::string& type : plantTypes()) {
    PlantOptions options;
    options.type = type;
    const auto plant = makePlant(options, CameraOptions());
    EXPECT_EQ(static_cast<int>(plant->stateNames().size()), plant->stateDim()) << type;
    EXPECT_EQ(static_cast<int>(plant->torqueNames().size()), plant->torqueDim()) << type;
    EXPECT_LE(static_cast<int>(plant->jointNames().size()), plant->stateDim()) << type;
  }
}

TEST(Plant, DrawsStartStatesWithTheGivenMeanAndSpread) {
  const auto plant = pendulum();
  std::mt19937_64 engine = startStream(1, 0, false);
  constexpr int kDraws = 20000;
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  Eigen::Array2d sum_of_squares = Eigen::Array2d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Array2d start = plant->drawStart(engine);
    sum += start;
    sum_of_squares += start.square();
  }
  // Five standard errors: 0.1 / sqrt(n) of the mean, 0.1 / sqrt(2 n) of the deviation.
  EXPECT_LT((sum / kDraws).abs().maxCoeff(), 5 * 0.1 / std::sqrt(kDraws));
  EXPECT_LT(((sum_of_squares / kDraws).sqrt() - 0.1).abs().maxCoeff(),
            5 * 0.1 / std::sqrt(2.0 * kDraws));
}

TEST(Plant, StartsHangingAtRestWithoutSpread) {
  PlantOptions options;
  options.start_std = 0.0;
  std::mt19937_64 engine = startStream(1, 0, false);
  EXPECT_EQ(makePlant(options, CameraOptions())->drawStart(engine), Eigen::Vector2d::Zero());
}

TEST(StartStream, GivesTheSameStartForTheSameArguments) {
  const auto plant = pendulum();
  std::mt19937_64 first = startStream(12345678901234ULL, 3, true);
  std::mt19937_64 second = startStream(12345678901234ULL, 3, true);
  EXPECT_EQ(plant->drawStart(first), plant->drawStart(second));
}

TEST(StartStream, DiffersBetweenSeedsTrialsAndEvaluation) {
  std::set<std::uint64_t> values;
  int streams = 0;
  // 2^32 differs from 0 in its high half only: both halves of the seed have to count.
  for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, 1ULL << 32}) {
    for (std::uint32_t trial = 0; trial < 20; ++trial) {
      for (const bool evaluation : {false, true}) {
        values.insert(startStream(seed, trial, evaluation)());
        ++streams;
      }
    }
  }
  EXPECT_EQ(static_cast<int>(values.size()), streams);
}

}  // namespace
}  // namespace ddm
