// Tests of the receding-horizon policy: what it refuses, and that trials do not see each other.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_policy.h"

#include <ddm_msgs/testing/expect_error.h>
#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "model_planner.h"
#include "random_model.h"

namespace ddm {
namespace {

constexpr int kNumSteps = 6;

std::shared_ptr<const Ddm> sharedModel(const RandomModelOptions& options = {}) {
  return std::make_shared<const Ddm>(randomModel(options));
}

/// First torques of the plans for a fixed row of images.
std::vector<double> torquesOfATrial(Policy* policy, const TrialId& id) {
  policy->startTrial(id);
  std::vector<double> torques;
  for (int step = 0; step < kNumSteps; ++step) {
    policy->observe(randomGrey(8, 50 + step));
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
    policy.observe(randomGrey(8, 3));
    if (!model_has_goal) {
      EXPECT_THROW(policy.plan(), std::logic_error);
    }
    for (const unsigned seed : {4U, 5U}) {
      policy.setGoal(randomGrey(8, seed));
      EXPECT_EQ(policy.plan().goal_feature, model->encode(randomGrey(8, seed)));
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

TEST(MpcPolicy, AcceptsLessTorqueThanTheModelKnowsAndKeepsToIt) {
  MpcOptions options;
  options.max_torque = {0.5};
  MpcPolicy policy(sharedModel(), options);
  for (const double u : torquesOfATrial(&policy, TrialId())) EXPECT_LE(std::abs(u), 0.5);
}

TEST(MpcPolicy, GivesTheSameTorquesWhenATrialIsRunAgain) {
  MpcPolicy policy(sharedModel(), MpcOptions());
  const TrialId id{7, 2, false};
  const std::vector<double> first = torquesOfATrial(&policy, id);
  torquesOfATrial(&policy, TrialId{8, 3, true});
  EXPECT_EQ(torquesOfATrial(&policy, id), first) << "startTrial() must forget the trial before";
}

TEST(MpcPolicy, TakesAnotherHorizonAndWeightOfTorqueInTheMiddleOfATrial) {
  RandomModelOptions random;
  random.model.order = 3;
  const auto model = sharedModel(random);
  MpcOptions other;
  other.horizon = 4;
  other.control_weight = 0.5;
  MpcPolicy turned(model, MpcOptions()), from_the_start(model, other);
  for (MpcPolicy* policy : {&turned, &from_the_start}) {
    policy->startTrial(TrialId());
    for (int step = 0; step < 3; ++step) {
      policy->observe(randomGrey(8, 50 + step));
      policy->apply(Eigen::VectorXd::Constant(1, step));
    }
    policy->setHorizon(4);
    policy->setControlWeight(0.5);
    policy->observe(randomGrey(8, 60));
  }
  EXPECT_EQ(turned.plan().torques, from_the_start.plan().torques);
}

TEST(MpcPolicy, PlansTheSameWhenItIsTurnedToWhatItHasAlready) {
  const auto model = sharedModel();
  MpcPolicy plain(model, MpcOptions()), turned(model, MpcOptions());
  for (int step = 0; step < kNumSteps; ++step) {
    std::vector<Plan> plans;
    for (MpcPolicy* policy : {&plain, &turned}) {
      if (step == 0) policy->startTrial(TrialId());
      policy->observe(randomGrey(8, 50 + step));
      plans.push_back(policy->plan());
      policy->apply(plans.back().torques.col(0));
    }
    turned.setHorizon(MpcOptions().horizon);
    turned.setControlWeight(MpcOptions().control_weight);
    EXPECT_EQ(plans[0].torques, plans[1].torques) << "step " << step;
  }
}

TEST(MpcPolicy, PlansByTimeOnlyWithAModelThatHasLandmarksAndNamesTheRemedies) {
  MpcOptions options;
  options.cost = "time";
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&options] { MpcPolicy policy(sharedModel(), options); },
      {"mpc/cost time", "landmarks", "train it again", "distance"}));
}

/// A model with some landmarks.
std::shared_ptr<const Ddm> modelWithMotors(int torque_dim) {
  RandomModelOptions options;
  options.torque_dim = torque_dim;
  const Ddm random = randomModel(options);
  ModelInfo info;  // z_t, z_{t-1}, u_{t-1} of each landmark
  info.landmarks = testing::randomMatrix(2 + 2 + torque_dim, 4, 7).cast<float>();
  return std::make_shared<const Ddm>(random.options(), random.imageSize(), torque_dim, random.pca(),
                                     random.theta(), random.goal(), info);
}

TEST(MpcPolicy, PlansByTimeForAtMostThreeMotorsAndNamesTheRemedy) {
  MpcOptions options;
  options.cost = "time";
  EXPECT_NO_THROW(MpcPolicy(modelWithMotors(3), options));
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [&options] { MpcPolicy policy(modelWithMotors(4), options); },
      {"mpc/cost time", "at most 3 motors", "got 4", "set mpc/cost to distance"}));
  options.cost = "distance";
  EXPECT_NO_THROW(MpcPolicy(modelWithMotors(6), options));
}

TEST(MpcPolicy, PlansFromTheEncodedImageToTheGoalOfTheModel) {
  const auto model = sharedModel();
  MpcPolicy policy(model, MpcOptions());
  policy.startTrial(TrialId());
  const Grey grey = randomGrey(8, 3);
  policy.observe(grey);
  const Plan plan = policy.plan();
  EXPECT_EQ(plan.features.col(0), model->encode(grey));
  EXPECT_EQ(plan.goal_feature, model->goalFeature());
}

TEST(MpcPolicy, TellsTheDistanceToTheGoalInUnitsOfTheSpread) {
  const Ddm random = randomModel({});
  ModelInfo info;
  info.feature_spread = 0.25;
  const auto model =
      std::make_shared<const Ddm>(random.options(), random.imageSize(), random.torqueDim(),
                                  random.pca(), random.theta(), random.goal(), info);
  MpcPolicy policy(model, MpcOptions());
  policy.startTrial({});
  policy.observe(random.goal());
  EXPECT_NEAR(policy.goalDistance().value(), 0.0, 1e-12);
  policy.observe(randomGrey(8, 50));
  const double distance = (model->encode(randomGrey(8, 50)) - model->goalFeature()).norm();
  EXPECT_GT(distance, 0.01);
  EXPECT_NEAR(policy.goalDistance().value(), 4.0 * distance, 1e-12);
}

TEST(MpcPolicy, TellsNoDistanceInUnitsThatTheModelDoesNotKnow) {
  MpcPolicy policy(sharedModel(), MpcOptions());
  policy.startTrial({});
  policy.observe(randomGrey(8, 50));
  EXPECT_FALSE(policy.goalDistance().has_value());
}

TEST(MpcPolicy, RemembersTheTorqueThatWasAppliedWhoeverDecidedIt) {
  const auto model = sharedModel();
  const TrialId id;
  const auto secondPlan = [&](double applied) {
    MpcPolicy policy(model, MpcOptions());
    policy.startTrial(id);
    policy.observe(randomGrey(8, 3));
    policy.apply(Eigen::VectorXd::Constant(1, applied));
    policy.observe(randomGrey(8, 4));
    return policy.plan();
  };
  History x(2, 2, 1);
  x.observe(model->encode(randomGrey(8, 3)));
  x.apply(Eigen::VectorXd::Constant(1, 5.0));
  x.observe(model->encode(randomGrey(8, 4)));
  ModelPlanner planner(*model, MpcOptions());
  std::mt19937_64 rng = randomStream(id, StreamRole::kPlannerStarts);
  EXPECT_EQ(secondPlan(5.0).torques, planner.solve(x, model->goalFeature(), &rng).torques);
  EXPECT_NE(secondPlan(5.0).torques, secondPlan(-5.0).torques);
}

TEST(MpcPolicy, PlansWithTheErrorOfItsLastPredictionAddedToAllOfThem) {
  const auto model = sharedModel();
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 2.0);
  History x(2, 2, 1);
  x.observe(model->encode(randomGrey(8, 3)));
  const Eigen::VectorXd predicted = model->predict(x, u);
  x.apply(u);
  x.observe(model->encode(randomGrey(8, 4)));
  const Eigen::VectorXd error = model->encode(randomGrey(8, 4)) - predicted;
  for (const double gain : {0.0, 0.4, 1.0}) {
    MpcOptions options;
    options.offset_gain = gain;
    MpcPolicy policy(model, options);
    policy.startTrial(TrialId());
    policy.observe(randomGrey(8, 3));
    policy.apply(u);
    policy.observe(randomGrey(8, 4));
    const Plan plan = policy.plan();
    const Eigen::VectorXd first = model->predict(x, plan.torques.col(0)) + gain * error;
    EXPECT_TRUE(plan.features.col(1).isApprox(first, 1e-12)) << "gain " << gain;
  }
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
    const Eigen::VectorXd z = model->encode(randomGrey(8, 50 + step));
    if (step > 0) {
      offset = 0.6 * offset + 0.4 * (z - model->predict(x, u));
      x.apply(u);
    }
    x.observe(z);
    policy.observe(randomGrey(8, 50 + step));
    if (step < 3) policy.apply(u);
  }
  const Plan plan = policy.plan();
  EXPECT_TRUE(
      plan.features.col(1).isApprox(model->predict(x, plan.torques.col(0)) + offset, 1e-12));
  policy.apply(u);
  policy.startTrial(TrialId());
  policy.observe(randomGrey(8, 3));
  History rest(2, 2, 1);
  rest.observe(model->encode(randomGrey(8, 3)));
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
    policy.observe(randomGrey(8, 3));
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

TEST(MpcPolicy, RefusesAnImageOfAnotherSize) {
  MpcPolicy policy(sharedModel(), MpcOptions());
  policy.startTrial(TrialId());
  EXPECT_THROW(policy.observe(randomGrey(9, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
