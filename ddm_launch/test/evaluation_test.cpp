// Tests of the evaluation: when a greedy evaluation counts as a success.
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation.h"

#include <ddm_plant_plugin/testing/toy_plant.h>
#include <ddm_sim/pendulum.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ddm {
namespace {

using States = std::vector<Eigen::VectorXd>;

constexpr double kDegree = kPi / 180.0;

class EvaluationTest : public ::testing::Test {
 protected:
  static Eigen::VectorXd at(double angle) { return Eigen::Vector2d(angle, 0.0); }

  /// `num_settled` images at the goal, after images far from the goal.
  static States arriving(int num_settled, int num_frames = 40) {
    States states(num_frames, at(0.0));
    for (int i = num_frames - num_settled; i < num_frames; ++i) states[i] = at(kPi);
    return states;
  }

  /// Evaluates an episode without torques.
  Evaluation evaluated(const States& states) const {
    return evaluate(plant_, states, States(states.size(), Eigen::VectorXd::Zero(1)));
  }

  Pendulum plant_{PendulumOptions()};
  EvaluationOptions options_;
};

TEST_F(EvaluationTest, SuccessTakesTheLastTenFramesAtTheGoal) {
  EXPECT_FALSE(evaluated(arriving(9)).success);
  EXPECT_TRUE(evaluated(arriving(10)).success);
  EXPECT_TRUE(evaluated(arriving(9)).known);  // failures are known results too
  States states(40, at(kPi));
  states.back() = at(kPi - 11.0 * kDegree);
  EXPECT_FALSE(evaluated(states).success);
  EXPECT_NEAR(evaluated(states).final_error.value(), 11.0, 1e-12);
}

TEST_F(EvaluationTest, StrictSuccessTakesTheLast25) {
  EXPECT_TRUE(evaluated(arriving(24)).success);
  EXPECT_FALSE(evaluated(arriving(24)).success_strict);
  EXPECT_TRUE(evaluated(arriving(25)).success_strict);
  EXPECT_TRUE(evaluated(arriving(7, 7)).success_strict);  // all images of a shorter episode
  EXPECT_FALSE(evaluated(arriving(6, 7)).success);
}

TEST_F(EvaluationTest, AnglesCountModuloAWholeTurn) {
  for (const double goal : {kPi, -kPi, 5.0 * kPi, -7.0 * kPi}) {
    const Evaluation evaluation = evaluated(States(40, at(goal + 9.0 * kDegree)));
    EXPECT_TRUE(evaluation.success) << goal;
    EXPECT_NEAR(evaluation.final_error.value(), 9.0, 1e-9) << goal;
    EXPECT_FALSE(evaluated(States(40, at(goal - 10.1 * kDegree))).success) << goal;
  }
}

TEST_F(EvaluationTest, WithoutGroundTruthNothingIsKnown) {
  const Evaluation evaluation = evaluated({});
  EXPECT_FALSE(evaluation.known);
  EXPECT_FALSE(evaluation.success);
  EXPECT_FALSE(evaluation.final_error.has_value());
  EXPECT_FALSE(evaluation.total_reward.has_value());
}

TEST(EvaluationOfRewards, CountsTheStepsOfLostFramesAndNoMoreStepsThanARunHas) {
  testing::ToyPlant plant(testing::colourfulToy());
  const std::vector<int> steps = {1, 3, 1, 2};  // time steps between successive images
  States states, torques;
  std::vector<double> times;
  double expected = 0.0, time = 0.4;
  int num_steps = 0;
  for (int t = 0; t < 30; ++t) {
    const Eigen::VectorXd u = Eigen::VectorXd::Constant(1, t % 2 == 0 ? 0.4 : -0.3);
    states.push_back(plant.state());
    torques.push_back(u);
    times.push_back(time);
    for (int i = 0; i < steps[static_cast<std::size_t>(t % 4)]; ++i) {
      if (num_steps++ < 30) expected += plant.stepReward(plant.state(), u).value();
      plant.step(u);
      time += plant.info().dt;
    }
  }
  EXPECT_NEAR(evaluate(plant, states, torques, times).total_reward.value(), expected, 1e-9);
  const double without = evaluate(plant, states, torques).total_reward.value();
  EXPECT_GT(std::abs(without - expected), 1e-3);
}

TEST(RequestFor, AnEvaluationLastsAsLongAsThePlantSaysAndElseAsATrial) {
  Configuration configuration;
  configuration.trial.num_steps = 60;
  EXPECT_EQ(requestFor(configuration, 0, /*evaluation=*/true).num_steps, 60);
  configuration.plant_info.evaluation_steps = 200;
  EXPECT_EQ(requestFor(configuration, 0, /*evaluation=*/true).num_steps, 200);
  EXPECT_EQ(requestFor(configuration, 0, /*evaluation=*/false).num_steps, 60);
}

TEST_F(EvaluationTest, WithoutGroundTruthTheLastFramesMustBeNearInFeatures) {
  options_.goal_distance = 0.5;
  std::vector<double> distances(40, 0.6);
  std::fill(distances.end() - 24, distances.end(), 0.5);
  EXPECT_TRUE(evaluateFeatures(distances, options_).success);
  EXPECT_FALSE(evaluateFeatures(distances, options_).success_strict);
  EXPECT_FALSE(evaluateFeatures(distances, options_).final_error.has_value());
  distances[30] = 0.51;
  EXPECT_TRUE(evaluateFeatures(distances, options_).known);
  EXPECT_FALSE(evaluateFeatures(distances, options_).success);
}

TEST_F(EvaluationTest, WithoutAToleranceOrFeaturesNothingIsKnown) {
  EXPECT_FALSE(evaluateFeatures(std::vector<double>(40, 0.0), options_).known);
  options_.goal_distance = 0.5;
  EXPECT_FALSE(evaluateFeatures({}, options_).known);
  const std::vector<double> distances(40, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(evaluateFeatures(distances, options_).success);
}

TEST(Quantile, IsTheValueThatAFractionDoesNotExceed) {
  const std::vector<double> values = {5.0, 1.0, 4.0, 2.0, 3.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 0.2), 1.0);
  EXPECT_EQ(quantile(values, 0.5), 3.0);
  EXPECT_EQ(quantile(values, 0.99), 5.0);
  EXPECT_EQ(quantile(values, 1.0), 5.0);
  EXPECT_EQ(quantile({}, 0.5), 0.0);
}

TEST(WilsonInterval, HoldsTheRatesThatTheRunsDoNotSpeakAgainst) {
  // At each end, p is 1.96 standard errors of p away from the observed rate.
  for (const int successes : {1, 7, 19}) {
    const auto interval = wilsonInterval(successes, 20);
    for (const double p : {interval.first, interval.second}) {
      EXPECT_NEAR(std::abs(successes / 20.0 - p), 1.959963984540054 * std::sqrt(p * (1 - p) / 20.0),
                  1e-12);
    }
    EXPECT_LT(interval.first, successes / 20.0);
    EXPECT_GT(interval.second, successes / 20.0);
  }
  EXPECT_EQ(wilsonInterval(0, 20).first, 0.0);
  EXPECT_EQ(wilsonInterval(20, 20).second, 1.0);
  EXPECT_NEAR(wilsonInterval(20, 20).first, 20.0 / (20.0 + 1.96 * 1.96), 1e-5);
}

}  // namespace
}  // namespace ddm
