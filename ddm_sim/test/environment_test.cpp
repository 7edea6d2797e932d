// Tests of the environment: images, time, and the begin of an episode.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/environment.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ddm_plant_plugin/testing/toy_plant.h"
#include "ddm_sim/pendulum.h"

namespace ddm {
namespace {

using testing::allNuisances;
using testing::ToyPlant;

constexpr std::uint64_t kSeed = 7;
constexpr std::uint32_t kTrial = 3;

PendulumOptions quickPendulum() {
  PendulumOptions options;
  options.dt = 0.1;
  return options;
}

std::unique_ptr<Plant> quickPlant() { return std::make_unique<Pendulum>(quickPendulum()); }

Eigen::VectorXd torqueOf(double value) { return Eigen::VectorXd::Constant(1, value); }

/// Plant and camera without the class Environment.
struct ByHand {
  Pendulum plant{quickPendulum()};
  Camera camera{allNuisances(), quickPendulum().dt};

  std::optional<RenderedImage> begin() {
    std::mt19937_64 starts = randomStream({kSeed, kTrial, true}, StreamRole::kStart);
    plant.setState(plant.drawStart(starts));
    camera.begin({kSeed, kTrial, true});
    return look();
  }
  std::optional<RenderedImage> step(double value) {
    plant.step(torqueOf(value));
    return look();
  }
  std::optional<RenderedImage> look() { return camera.capture(plant.render(plant.state())); }
};

TEST(Environment, GoesOnUnderTheSameTorqueUntilAFrameIsSeenAndCountsTheLostOnes) {
  Environment environment(quickPlant(), allNuisances());
  ByHand by_hand;
  environment.reset({kSeed, kTrial, true});
  by_hand.begin();
  std::uint64_t steps = 0;
  for (int frame = 1; frame <= 40; ++frame) {
    const double value = frame % 2 == 0 ? 4.0 : -1.0;
    const RenderedImage seen = environment.stepUntilSeen(torqueOf(value));
    std::optional<RenderedImage> expected;
    while (!expected) {
      expected = by_hand.step(value);
      ++steps;
    }
    ASSERT_EQ(seen.bytes, expected->bytes) << frame;
    ASSERT_EQ(environment.plant().state(), by_hand.plant.state()) << frame;
    EXPECT_EQ(environment.numSteps(), steps);
    EXPECT_DOUBLE_EQ(environment.time(), 0.1 * static_cast<double>(steps));
  }
  EXPECT_GT(steps, 40U);
}

TEST(Environment, ChangesNothingWhereAStartIsRefused) {
  ToyPlant::Traits traits = testing::colourfulToy();
  Environment environment(std::make_unique<ToyPlant>(traits), allNuisances());
  Environment undisturbed(std::make_unique<ToyPlant>(traits), allNuisances());
  for (Environment* each : {&environment, &undisturbed}) {
    each->reset({kSeed, kTrial, true});
    each->stepUntilSeen(torqueOf(2.0));
  }
  EXPECT_THROW(environment.reset({1, 1, false}, Eigen::VectorXd::Zero(3)), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(environment.reset({1, 1, false}, Eigen::Vector2d(0.0, nan)), std::invalid_argument);
  EXPECT_EQ(environment.plant().state(), undisturbed.plant().state());
  EXPECT_EQ(environment.plant().goal(), undisturbed.plant().goal());
  EXPECT_EQ(environment.numSteps(), undisturbed.numSteps());
  EXPECT_EQ(environment.applied(), undisturbed.applied());
  for (int t = 0; t < 20; ++t) {
    const std::optional<RenderedImage> expected = undisturbed.step(torqueOf(1.0));
    const std::optional<RenderedImage> seen = environment.step(torqueOf(1.0));
    ASSERT_EQ(seen.has_value(), expected.has_value());
    if (!seen) continue;
    ASSERT_EQ(seen->bytes, expected->bytes);
  }
}

TEST(Environment, DrawsAGoalForEachRunAndShowsItOnTheGoalImage) {
  const auto toy = [] { return std::make_unique<ToyPlant>(testing::colourfulToy()); };
  const ToyPlant alone(testing::colourfulToy());
  Environment environment(toy(), CameraOptions());
  EXPECT_EQ(environment.plant().goal(), alone.info().goal);
  std::set<double> goals;
  std::set<std::vector<std::uint8_t>> images;
  for (const bool evaluation : {false, true}) {
    for (std::uint32_t trial = 0; trial < 5; ++trial) {
      environment.reset({kSeed, trial, evaluation});
      const Eigen::VectorXd goal = environment.plant().goal();
      EXPECT_EQ(goal, goalOf(alone, {kSeed, trial, evaluation}));
      std::mt19937_64 starts = randomStream({kSeed, trial, evaluation}, StreamRole::kStart);
      EXPECT_NE(alone.drawGoal(starts), goal) << "goals have a stream of their own";
      EXPECT_EQ(environment.goalImage().bytes, alone.render(goal).bytes);
      EXPECT_EQ(environment.plant().goalError(goal), 0.0);
      goals.insert(goal[0]);
      images.insert(environment.goalImage().bytes);
      // An explicit initial state does not change the goal of the episode.
      environment.reset({kSeed, trial, evaluation}, Eigen::Vector2d(0.0, 0.0));
      EXPECT_EQ(environment.plant().goal(), goal);
    }
  }
  EXPECT_EQ(goals.size(), 10U);
  // Fewer than goals, because different goals can give the same image.
  EXPECT_GT(images.size(), 3U);
}

}  // namespace
}  // namespace ddm
