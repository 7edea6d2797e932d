// Tests of the controller: exploration and its random streams; the receding-horizon policy.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/controller.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "random_model.h"

namespace ddm {
namespace {

/// Always answers with the same torque and writes down what it is told.
class ConstantPolicy : public Policy {
 public:
  void startTrial(const TrialId& id) override { trials.push_back(id.trial); }
  void observe(const Image& /*image*/) override { ++num_images; }
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
    decisions.push_back(policy->decide(randomImage(8, step)));
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
  EXPECT_EQ(constant->exploring, (std::vector<bool>{false, true}));
}

TEST(EpsilonGreedy, TellsThePolicyWhatActedBeforeTheNextImage) {
  const auto onlooker = std::make_shared<ConstantPolicy>();
  EpsilonGreedy policy(onlooker, explore(0.0), TrialId());
  policy.decide(randomImage(8, 1));
  policy.decide(randomImage(8, 2));  // the first decision acted
  policy.correctTorque(Eigen::VectorXd::Constant(1, 0.5));
  policy.decide(randomImage(8, 3));
  policy.startSegment();  // no single torque acted
  policy.decide(randomImage(8, 4));
  EXPECT_EQ(onlooker->applied, (std::vector<double>{ConstantPolicy::kTorque, 0.5}));
  EXPECT_EQ(onlooker->num_segments, 1);
  EXPECT_EQ(onlooker->num_images, 4);
  EXPECT_THROW(policy.correctTorque(Eigen::VectorXd::Zero(2)), std::invalid_argument);
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

TEST(EpsilonGreedy, HoldsARandomTorqueForOneToTheGivenSteps) {
  EpsilonGreedy policy(nullptr, explore(1.0, /*hold_steps=*/3), TrialId());
  const std::vector<double> u = torques(decide(&policy, 600));
  std::map<int, int> counts;  // of torques held for so many steps
  int held = 1;
  for (size_t step = 1; step < u.size(); ++step, ++held) {
    if (u[step] == u[step - 1]) continue;
    ++counts[held];
    held = 0;
  }
  ASSERT_EQ(counts.size(), 3U);
  for (const auto& [steps, count] : counts) {
    EXPECT_TRUE(steps >= 1 && steps <= 3) << steps;
    EXPECT_NEAR(count, 100, 40) << steps;  // 300 torques are held for 2 steps in the mean
  }
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

TEST(EpsilonGreedy, DrawsTheSameTorquesAgainAndOthersInAnotherTrialSeedOrEvaluation) {
  EXPECT_EQ(randomTrial({5, 2, false}), randomTrial({5, 2, false}));
  const std::set<std::vector<double>> distinct = {
      randomTrial({5, 2, false}), randomTrial({5, 2, true}), randomTrial({5, 3, false}),
      randomTrial({6, 2, false}), randomTrial({5 + (1ULL << 32), 2, false})};
  EXPECT_EQ(distinct.size(), 5U);
}

TEST(EpsilonGreedy, RefusesOptionsOutOfRange) {
  const auto policy = std::make_shared<ConstantPolicy>();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double epsilon : {-0.1, 1.1, nan}) {
    EXPECT_THROW(EpsilonGreedy(policy, explore(epsilon), TrialId()), std::invalid_argument);
  }
  EXPECT_THROW(EpsilonGreedy(nullptr, explore(0.99), TrialId()), std::invalid_argument);
  EXPECT_THROW(EpsilonGreedy(policy, explore(0.5, 0), TrialId()), std::invalid_argument);
}

constexpr int kNumSteps = 6;

std::shared_ptr<const Ddm> sharedModel(const RandomModelOptions& options = {}) {
  return std::make_shared<const Ddm>(randomModel(options));
}

/// First torques of the plans for a fixed row of images.
std::vector<double> torquesOfATrial(Policy* policy, const TrialId& id) {
  policy->startTrial(id);
  std::vector<double> torques;
  for (int step = 0; step < kNumSteps; ++step) {
    policy->observe(randomImage(8, 50 + step));
    const Answer answer = policy->answer();
    EXPECT_EQ(answer.torque, answer.plan->torques.col(0));
    torques.push_back(answer.torque[0]);
    policy->apply(answer.torque);
  }
  return torques;
}

TEST(MpcPolicy, PlansToTheGoalItIsGivenWhateverTheModelHas) {
  for (const bool model_has_goal : {false, true}) {
    RandomModelOptions options;
    options.goal = model_has_goal;
    const auto model = sharedModel(options);
    MpcPolicy policy(model, MpcOptions());
    EXPECT_EQ(policy.hasGoal(), model_has_goal);
    policy.startTrial(TrialId());
    policy.observe(randomImage(8, 3));
    if (!model_has_goal) {
      EXPECT_THROW(policy.plan(), std::logic_error);
    }
    for (const unsigned seed : {4U, 5U}) {
      policy.setGoal(randomImage(8, seed));
      EXPECT_EQ(policy.plan().goal_feature, model->encode(randomImage(8, seed)));
    }
  }
}

TEST(MpcPolicy, RefusesMoreTorqueThanTheModelKnowsAndNamesBothKeys) {
  MpcOptions options;
  options.max_torque = {6.5};
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&options] { MpcPolicy policy(sharedModel(), options); },
      {"mpc/max_torque", "model/max_torque", "6.5", "6 N m"}));
}

TEST(MpcPolicy, GivesTheSameTorquesWhenATrialIsRunAgain) {
  MpcPolicy policy(sharedModel(), MpcOptions());
  const TrialId id{7, 2, false};
  const std::vector<double> first = torquesOfATrial(&policy, id);
  torquesOfATrial(&policy, TrialId{8, 3, true});
  EXPECT_EQ(torquesOfATrial(&policy, id), first) << "startTrial() must forget the trial before";
}

/// A model with some support states.
std::shared_ptr<const Ddm> modelWithMotors(int torque_dim) {
  RandomModelOptions options;
  options.torque_dim = torque_dim;
  return std::make_shared<const Ddm>(withSupportStates(randomModel(options), 4));
}

TEST(MpcPolicy, PlansByTimeForAtMostThreeMotorsWithSupportStatesAndNamesTheRemedy) {
  MpcOptions options;
  options.cost = "time";
  EXPECT_NO_THROW(MpcPolicy(modelWithMotors(3), options));
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&options] { MpcPolicy policy(modelWithMotors(4), options); },
      {"mpc/cost time", "at most 3 motors", "got 4", "set mpc/cost to distance"}));
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&options] { MpcPolicy policy(sharedModel(), options); },
      {"mpc/cost time", "support states", "train it again", "distance"}));
  options.cost = "distance";
  EXPECT_NO_THROW(MpcPolicy(modelWithMotors(6), options));
}

TEST(MpcPolicy, TellsTheDistanceToTheGoalInUnitsOfTheSpread) {
  ModelInfo info;
  info.feature_spread = 0.25;
  const auto model = std::make_shared<const Ddm>(withInfo(randomModel({}), info));
  MpcPolicy policy(model, MpcOptions()), unknown(sharedModel(), MpcOptions());
  unknown.startTrial({});
  unknown.observe(model->goal());
  EXPECT_FALSE(unknown.goalDistance().has_value());
  policy.startTrial({});
  policy.observe(model->goal());
  EXPECT_NEAR(policy.goalDistance().value(), 0.0, 1e-12);
  policy.observe(randomImage(8, 50));
  const double distance = (model->encode(randomImage(8, 50)) - model->goalFeature()).norm();
  EXPECT_GT(distance, 0.01);
  EXPECT_NEAR(policy.goalDistance().value(), 4.0 * distance, 1e-12);
}

TEST(MpcPolicy, RemembersTheTorqueThatWasAppliedWhoeverDecidedIt) {
  const auto model = sharedModel();
  const TrialId id;
  const auto secondPlan = [&](double applied) {
    MpcPolicy policy(model, MpcOptions());
    policy.startTrial(id);
    policy.observe(randomImage(8, 3));
    policy.apply(Eigen::VectorXd::Constant(1, applied));
    policy.observe(randomImage(8, 4));
    return policy.plan();
  };
  History x(2, 2, 1);
  x.observe(model->encode(randomImage(8, 3)));
  x.apply(Eigen::VectorXd::Constant(1, 5.0));
  x.observe(model->encode(randomImage(8, 4)));
  ModelPlanner planner(*model, MpcOptions());
  std::mt19937_64 rng = randomStream(id, StreamRole::kPlannerStarts);
  EXPECT_EQ(secondPlan(5.0).torques, planner.solve(x, model->goalFeature(), &rng).torques);
  EXPECT_NE(secondPlan(5.0).torques, secondPlan(-5.0).torques);
}

TEST(MpcPolicy, AveragesTheErrorsOfItsPredictionsAndForgetsThemWithTheTrial) {
  const auto model = sharedModel();
  MpcOptions options;
  options.offset_gain = 0.4;
  MpcPolicy policy(model, options);
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 2.0);
  History x(2, 2, 1);
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(2);
  policy.startTrial(TrialId());
  for (int step = 0; step < 4; ++step) {
    const Eigen::VectorXd z = model->encode(randomImage(8, 50 + step));
    if (step > 0) {
      offset = 0.6 * offset + 0.4 * (z - model->predict(x, u));
      x.apply(u);
    }
    x.observe(z);
    policy.observe(randomImage(8, 50 + step));
    if (step < 3) policy.apply(u);
  }
  const Plan plan = policy.plan();
  EXPECT_TRUE(
      plan.features.col(1).isApprox(model->predict(x, plan.torques.col(0)) + offset, 1e-12));
  policy.apply(u);
  policy.startTrial(TrialId());
  policy.observe(randomImage(8, 3));
  History rest(2, 2, 1);
  rest.observe(model->encode(randomImage(8, 3)));
  const Plan next = policy.plan();
  EXPECT_TRUE(next.features.col(1).isApprox(model->predict(rest, next.torques.col(0)), 1e-12));
}

TEST(MpcPolicy, CutsAPlanShortWhenTheBudgetOrTheStopSaysSo) {
  const auto firstPlan = [](double time_budget, std::chrono::seconds age, bool stop) {
    MpcOptions options;
    options.time_budget = time_budget;
    MpcPolicy policy(sharedModel(), options);
    policy.setStop([stop] { return stop; });
    policy.startTrial(TrialId());
    policy.setArrival(std::chrono::steady_clock::now() - age);
    policy.observe(randomImage(8, 3));
    return policy.plan();
  };
  const Plan free = firstPlan(0.0, std::chrono::seconds(100), false);
  EXPECT_NE(free.status, PlanStatus::kTimeLimit);
  for (const Plan& plan : {firstPlan(1e-9, std::chrono::seconds(0), false),
                           firstPlan(60.0, std::chrono::seconds(100), false),
                           firstPlan(0.0, std::chrono::seconds(0), true)}) {
    EXPECT_EQ(plan.status, PlanStatus::kTimeLimit);
    EXPECT_EQ(plan.evaluations, 1);
    EXPECT_EQ(plan.torques, Eigen::MatrixXd::Zero(1, 15)) << "the first start, with no torque";
  }
  EXPECT_EQ(firstPlan(3600.0, std::chrono::seconds(0), false).torques, free.torques);
}

}  // namespace
}  // namespace ddm
