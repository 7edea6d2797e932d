// Tests of what all plants share: checks, saturation, start states and their random stream.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>

#include "ddm_msgs/testing/not_finite.h"
#include "ddm_sim/pendulum.h"
#include "ddm_sim/testing/toy_plant.h"

namespace ddm {
namespace {

using testing::ToyPlant;

std::unique_ptr<Plant> pendulum() { return std::make_unique<Pendulum>(PendulumOptions()); }

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
    const std::string message = e.what();
    EXPECT_NE(message.find("10 ..., 1000000 in all]"), std::string::npos) << message;
    EXPECT_LT(message.size(), 200U);
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

TEST(Plant, StartsHangingAtRestWithoutSpread) {
  PendulumOptions options;
  options.start_std = {0.0};
  std::mt19937_64 engine = startStream(1, 0, false);
  EXPECT_EQ(Pendulum(options).drawStart(engine), Eigen::Vector2d::Zero());
}

TEST(Plant, DrawsEachComponentOfAStartWithASpreadOfItsOwn) {
  ToyPlant::Traits traits;
  traits.info.start << 3.0, -4.0;
  traits.info.start_std << 0.0, 0.5;
  const ToyPlant plant(traits);
  std::mt19937_64 engine = startStream(1, 0, false);
  const Eigen::VectorXd start = plant.drawStart(engine);
  EXPECT_EQ(start[0], 3.0);
  EXPECT_NE(start[1], -4.0);
  EXPECT_LT(std::abs(start[1] + 4.0), 5 * 0.5);
}

TEST(Plant, TakesAGoalForATrialAndMeasuresTheErrorToIt) {
  ToyPlant plant{ToyPlant::Traits()};
  EXPECT_EQ(plant.goal(), plant.info().goal);
  EXPECT_EQ(plant.goalError(Eigen::Vector2d(0.25, 0.0)), 0.75);
  plant.setGoal(Eigen::Vector2d(0.5, 0.0));
  EXPECT_EQ(plant.goalError(Eigen::Vector2d(0.25, 0.0)), 0.25);
  EXPECT_EQ(plant.info().goal, Eigen::Vector2d(1.0, 0.0));  // that of the plant stays
  EXPECT_THROW(plant.setGoal(Eigen::VectorXd::Zero(1)), std::invalid_argument);
  EXPECT_THROW(plant.setGoal(Eigen::Vector2d(kNaN, 0.0)), std::invalid_argument);
  EXPECT_EQ(plant.goal(), Eigen::Vector2d(0.5, 0.0));
}

TEST(Plant, SaturatesEachMotorAtItsOwnLimit) {
  ToyPlant::Traits traits;
  traits.info.torque_names = {"left_n", "right_n"};
  traits.info.max_torque.resize(2);
  traits.info.max_torque << 1.0, 20.0;
  ToyPlant plant(traits);
  EXPECT_EQ(plant.step(Eigen::Vector2d(5.0, 5.0)), Eigen::Vector2d(1.0, 5.0));
  EXPECT_EQ(plant.step(Eigen::Vector2d(-0.5, -50.0)), Eigen::Vector2d(-0.5, -20.0));
}

TEST(Plant, HasNoRewardUnlessItSaysSo) {
  EXPECT_FALSE(pendulum()->reward(Eigen::Vector2d::Zero(), torque(1.0)));
  const ToyPlant plant(testing::colourfulToy());
  EXPECT_DOUBLE_EQ(plant.reward(Eigen::Vector2d(1.0, 2.0), torque(2.0)).value(), -5.4);
}

TEST(Plant, IsRewardedAfterAStepUnderTheTorqueThatActed) {
  EXPECT_FALSE(pendulum()->stepReward(Eigen::Vector2d::Zero(), torque(1.0)));
  const ToyPlant plant(testing::colourfulToy());  // moves by 0.1 u
  const Eigen::Vector2d state(1.0, 2.0);
  EXPECT_DOUBLE_EQ(plant.stepReward(state, torque(2.0)).value(), -(1.44 + 4.84 + 0.4));
  EXPECT_EQ(plant.stepReward(state, torque(60.0)), plant.stepReward(state, torque(6.0)));
  const Eigen::VectorXd next = state.array() + 0.2;  // where this torque leads
  EXPECT_DOUBLE_EQ(
      plant.stepReward(state, torque(2.0), 2).value(),
      plant.stepReward(state, torque(2.0)).value() + plant.stepReward(next, torque(2.0)).value());
  EXPECT_THROW(plant.stepReward(state, Eigen::Vector2d::Zero()), std::invalid_argument);
}

TEST(Plant, RefusesATargetUnlessItHasSuch) {
  EXPECT_THROW(pendulum()->goalAt(Eigen::Vector2d(0.1, 0.1)), std::invalid_argument);
}

TEST(Plant, RefusesAPictureThatIsNotWhatItsSizeSays) {
  const Picture sound{3, 2, 3, std::vector<std::uint8_t>(18, 7), std::vector<std::uint8_t>(6, 9)};
  Picture few = sound, dim = sound, uncovered = sound, flat = sound, none;
  few.bytes.pop_back();
  dim.channels = 2;
  uncovered.cover.pop_back();
  flat.height = 0;
  for (const Picture& picture : {few, dim, uncovered, flat, none}) {
    ToyPlant::Traits traits;
    traits.draw = [picture](const Eigen::VectorXd&) { return picture; };
    EXPECT_THROW(ToyPlant(traits).render(Eigen::Vector2d::Zero()), std::logic_error);
  }
  ToyPlant::Traits traits;
  traits.draw = [sound](const Eigen::VectorXd&) { return sound; };
  EXPECT_EQ(ToyPlant(traits).render(Eigen::Vector2d::Zero()).bytes, sound.bytes);
}

TEST(Plant, RefusesANextStateOfAnotherSizeAndDoesNotMove) {
  ToyPlant::Traits traits;
  traits.advance = [](const Eigen::VectorXd&, const Eigen::VectorXd&) {
    return Eigen::VectorXd(Eigen::VectorXd::Zero(1));
  };
  ToyPlant plant(traits);
  EXPECT_THROW(plant.step(torque(1.0)), std::logic_error);
  EXPECT_EQ(plant.state(), traits.info.start);
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

TEST(GoalOf, DiffersBetweenSeedsTrialsAndEvaluationAndIsNotDrawnWithTheStart) {
  const ToyPlant plant(testing::colourfulToy());
  std::set<double> goals;
  for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32}) {
    for (std::uint32_t trial = 0; trial < 20; ++trial) {
      for (const bool evaluation : {false, true}) {
        goals.insert(goalOf(plant, seed, trial, evaluation)[0]);
        std::mt19937_64 starts = startStream(seed, trial, evaluation);
        goals.insert(plant.drawGoal(starts)[0]);
      }
    }
  }
  EXPECT_EQ(goals.size(), 240U);
}

}  // namespace
}  // namespace ddm
