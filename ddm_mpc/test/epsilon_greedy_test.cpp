// Tests of epsilon-greedy exploration and of its random streams.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/epsilon_greedy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "ddm_mpc/mpc_policy.h"
#include "random_model.h"

namespace ddm {
namespace {

/// Always answers with the same torque and writes down what it is told.
class ConstantPolicy : public Policy {
 public:
  void startTrial(const TrialId& id) override { trials.push_back(id.trial); }
  void observe(const Grey& /*grey*/) override { ++num_images; }
  Answer answer() override {
    Answer answer;
    answer.torque = Eigen::VectorXd::Constant(1, kTorque);
    answer.solve_time = 0.5;
    return answer;
  }
  void apply(const Eigen::VectorXd& u) override { applied.push_back(u[0]); }
  void startSegment() override { ++num_segments; }
  void setExploring(bool on) override { exploring.push_back(on); }

  static constexpr double kTorque = 1.25;
  std::vector<std::uint32_t> trials;
  std::vector<double> applied;
  std::vector<bool> exploring;
  int num_images = 0;
  int num_segments = 0;
};

EpsilonGreedy::Options explore(double epsilon, int hold_steps = 1) {
  EpsilonGreedy::Options options;
  options.epsilon = epsilon;
  options.hold_steps = hold_steps;
  return options;
}

std::vector<Decision> decide(EpsilonGreedy* policy, int num_steps) {
  std::vector<Decision> decisions;
  for (int step = 0; step < num_steps; ++step) {
    decisions.push_back(policy->decide(randomGrey(8, step)));
  }
  return decisions;
}

std::vector<double> torques(const std::vector<Decision>& decisions) {
  std::vector<double> values;
  for (const Decision& decision : decisions) values.push_back(decision.torque[0]);
  return values;
}

std::vector<double> randomTrial(const TrialId& id) {
  EpsilonGreedy policy(nullptr, explore(1.0), id);
  return torques(decide(&policy, 20));
}

TEST(EpsilonGreedy, LetsThePolicyExploreWhereRandomTorquesAreWantedAndNowhereElse) {
  auto constant = std::make_shared<ConstantPolicy>();
  EpsilonGreedy greedy(constant, explore(0.0), TrialId());
  EpsilonGreedy exploring(constant, explore(0.2), TrialId());
  exploring.setEpsilon(0.0);
  EXPECT_EQ(constant->exploring, (std::vector<bool>{false, true, false}));
}

TEST(EpsilonGreedy, TellsThePolicyWhatActedBeforeTheNextImage) {
  const auto onlooker = std::make_shared<ConstantPolicy>();
  EpsilonGreedy policy(onlooker, explore(0.0), TrialId());
  policy.decide(randomGrey(8, 1));
  policy.decide(randomGrey(8, 2));  // the first decision acted
  policy.correctTorque(Eigen::VectorXd::Constant(1, 0.5));
  policy.decide(randomGrey(8, 3));
  policy.startSegment();  // no single torque acted
  policy.decide(randomGrey(8, 4));
  EXPECT_EQ(onlooker->applied, (std::vector<double>{ConstantPolicy::kTorque, 0.5}));
  EXPECT_EQ(onlooker->num_segments, 1);
  EXPECT_EQ(onlooker->num_images, 4);
  EXPECT_THROW(policy.correctTorque(Eigen::VectorXd::Zero(2)), std::invalid_argument);
}

TEST(EpsilonGreedy, NeverExploresAtEpsilonZero) {
  auto constant = std::make_shared<ConstantPolicy>();
  EpsilonGreedy policy(constant, explore(0.0), TrialId());
  for (const Decision& decision : decide(&policy, 500)) {
    EXPECT_FALSE(decision.exploratory);
    EXPECT_EQ(decision.solve_time, 0.5);
    EXPECT_FALSE(decision.plan.has_value());
    EXPECT_EQ(decision.torque[0], ConstantPolicy::kTorque);
  }
}

TEST(EpsilonGreedy, AlwaysExploresAtEpsilonOneAndNeedsNoModel) {
  EpsilonGreedy policy(nullptr, explore(1.0), TrialId());
  for (const Decision& decision : decide(&policy, 500)) {
    EXPECT_TRUE(decision.exploratory);
    EXPECT_FALSE(decision.solve_time.has_value());
  }
}

TEST(EpsilonGreedy, ExploresInAShareEpsilonOfTheSteps) {
  constexpr int kNumSteps = 10000;
  constexpr double kEpsilon = 0.2;
  EpsilonGreedy policy(std::make_shared<ConstantPolicy>(), explore(kEpsilon), TrialId());
  const std::vector<Decision> decisions = decide(&policy, kNumSteps);
  const double share =
      static_cast<double>(std::count_if(decisions.begin(), decisions.end(),
                                        [](const Decision& d) { return d.exploratory; })) /
      kNumSteps;
  EXPECT_NEAR(share, kEpsilon, 4.0 * std::sqrt(kEpsilon * (1.0 - kEpsilon) / kNumSteps));
}

TEST(EpsilonGreedy, DrawsUniformlyWithinTheBounds) {
  constexpr int kNumSteps = 8000;
  constexpr int kNumBins = 8;
  EpsilonGreedy::Options options = explore(1.0);
  constexpr double kLimit = 2.0;
  options.max_torque[0] = kLimit;
  EpsilonGreedy policy(nullptr, options, TrialId());
  std::vector<int> bins(kNumBins);
  for (const double u : torques(decide(&policy, kNumSteps))) {
    ASSERT_LE(std::abs(u), kLimit);
    ++bins[std::min(kNumBins - 1, static_cast<int>((u / kLimit + 1.0) * kNumBins / 2))];
  }
  const double expected = static_cast<double>(kNumSteps) / kNumBins;
  const double deviation = std::sqrt(expected * (1.0 - 1.0 / kNumBins));
  for (const int count : bins) EXPECT_NEAR(count, expected, 4.0 * deviation);
}

TEST(EpsilonGreedy, HoldsARandomTorqueForTheGivenSteps) {
  EpsilonGreedy policy(nullptr, explore(1.0, /*hold_steps=*/3), TrialId());
  const std::vector<double> u = torques(decide(&policy, 30));
  for (int step = 0; step < 30; step += 3) {
    EXPECT_EQ(u[step], u[step + 1]);
    EXPECT_EQ(u[step], u[step + 2]);
    if (step > 0) {
      EXPECT_NE(u[step], u[step - 1]);
    }
  }
}

TEST(EpsilonGreedy, GoesBackToPlansAfterAHeldTorque) {
  EpsilonGreedy policy(std::make_shared<ConstantPolicy>(), explore(0.3, /*hold_steps=*/4),
                       TrialId());
  const std::vector<Decision> decisions = decide(&policy, 400);
  int in_a_row = 0;
  int num_runs = 0;
  for (const Decision& decision : decisions) {
    if (decision.exploratory) {
      ++in_a_row;
    } else {
      EXPECT_EQ(in_a_row % 4, 0) << "a random torque was not held for 4 steps";
      if (in_a_row > 0) ++num_runs;
      in_a_row = 0;
    }
  }
  EXPECT_GT(num_runs, 10);
}

TEST(EpsilonGreedy, DrawsEachMotorsTorqueByItself) {
  EpsilonGreedy::Options options = explore(1.0);
  options.max_torque = (Eigen::VectorXd(3) << 6.0, 1.0, 0.01).finished();
  EpsilonGreedy policy(nullptr, options, TrialId());
  const Eigen::VectorXd u = policy.decide(randomGrey(8, 1)).torque;
  ASSERT_EQ(u.size(), 3);
  EXPECT_NE(u[0], u[1]);
  EXPECT_NE(u[1], u[2]);
  EXPECT_TRUE((u.cwiseAbs().array() <= options.max_torque.array()).all()) << u;
}

TEST(EpsilonGreedy, TellsThePolicyOfEachImageAndEachTorque) {
  auto constant = std::make_shared<ConstantPolicy>();
  EpsilonGreedy policy(constant, explore(0.5), TrialId{1, 9, false});
  std::vector<double> u = torques(decide(&policy, 40));
  u.pop_back();  // has not acted yet
  EXPECT_EQ(constant->trials, std::vector<std::uint32_t>{9});
  EXPECT_EQ(constant->num_images, 40);
  EXPECT_EQ(constant->applied, u);
}

TEST(EpsilonGreedy, ExploresTheSameWhateverThePlannerDoes) {
  const auto model = std::make_shared<const Ddm>(randomModel({}));
  MpcOptions many_starts;
  many_starts.num_starts = 7;
  many_starts.horizon = 3;
  const TrialId id{3, 1, false};
  EpsilonGreedy with_planner(std::make_shared<MpcPolicy>(model, many_starts), explore(0.5), id);
  EpsilonGreedy without(std::make_shared<ConstantPolicy>(), explore(0.5), id);
  const std::vector<Decision> planned = decide(&with_planner, 60);
  const std::vector<Decision> constant = decide(&without, 60);
  int num_exploratory = 0;
  for (int step = 0; step < 60; ++step) {
    ASSERT_EQ(planned[step].exploratory, constant[step].exploratory) << "step " << step;
    if (!planned[step].exploratory) continue;
    ++num_exploratory;
    EXPECT_EQ(planned[step].torque, constant[step].torque) << "step " << step;
  }
  EXPECT_GT(num_exploratory, 10);
}

TEST(EpsilonGreedy, GivesTheSameTorquesForTheSameRun) {
  EXPECT_EQ(randomTrial({5, 2, false}), randomTrial({5, 2, false}));
}

TEST(EpsilonGreedy, DrawsOtherTorquesInAnotherTrialSeedOrEvaluation) {
  const std::set<std::vector<double>> distinct = {
      randomTrial({5, 2, false}), randomTrial({5, 2, true}), randomTrial({5, 3, false}),
      randomTrial({6, 2, false}), randomTrial({5 + (1ULL << 32), 2, false})};
  EXPECT_EQ(distinct.size(), 5U);
}

TEST(EpsilonGreedy, TakesAnotherEpsilonFromTheNextImageOn) {
  const auto policy = std::make_shared<ConstantPolicy>();
  EpsilonGreedy turned(policy, explore(0.0), TrialId());
  for (const double epsilon : {0.0, 1.0, 0.0}) {
    turned.setEpsilon(epsilon);
    for (const Decision& decision : decide(&turned, 10)) {
      EXPECT_EQ(decision.exploratory, epsilon == 1.0);
    }
  }
  EXPECT_THROW(turned.setEpsilon(1.1), std::invalid_argument);
}

TEST(EpsilonGreedy, RefusesToPlanWithoutAModel) {
  EXPECT_THROW(EpsilonGreedy(nullptr, explore(0.99), TrialId()), std::invalid_argument);
  EpsilonGreedy random(nullptr, explore(1.0), TrialId());
  EXPECT_THROW(random.setEpsilon(0.99), std::invalid_argument);
}

TEST(EpsilonGreedy, RefusesOptionsOutOfRange) {
  const auto policy = std::make_shared<ConstantPolicy>();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double epsilon : {-0.1, 1.1, nan}) {
    EXPECT_THROW(EpsilonGreedy(policy, explore(epsilon), TrialId()), std::invalid_argument);
  }
  EXPECT_THROW(EpsilonGreedy(policy, explore(0.5, 0), TrialId()), std::invalid_argument);
  for (const double max_torque : {0.0, -1.0, nan}) {
    EpsilonGreedy::Options options;
    options.max_torque = (Eigen::VectorXd(2) << 1.0, max_torque).finished();
    EXPECT_THROW(EpsilonGreedy(policy, options, TrialId()), std::invalid_argument);
  }
  EpsilonGreedy::Options options;
  options.max_torque.resize(0);
  EXPECT_THROW(EpsilonGreedy(policy, options, TrialId()), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
