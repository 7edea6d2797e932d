// Tests of the saturating cost, and of the cost-to-go: it grows with the steps to the goal, along states that were seen.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/cost_to_go.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ddm_mpc/ddm_plan_cost.h"
#include "ddm_mpc/planner.h"
#include "random_model.h"

namespace ddm {
namespace {

constexpr double kStep = 0.1;  // what a torque of 1 N m moves a feature by

/// Two features, each pushed by a motor of its own: z_{t+1} = z_t + kStep u_t. Its support states are at
/// these features, at rest and moving by a step in each direction.
/// @param places  [2 x N]
Ddm pushedModel(const Eigen::MatrixXd& places, const std::vector<double>& max_torque = {1.0}) {
  RandomModelOptions options;
  options.torque_dim = 2;
  options.model.max_torque = max_torque;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2, 8);  // h = z_t, u_t, z_{t-1}, u_{t-1}
  A.leftCols(2).setIdentity();
  A.middleCols(2, 2) = kStep * Eigen::Matrix2d::Identity();
  const Ddm model = linearModel(options, A, Eigen::VectorXd::Zero(2));
  ModelInfo info;
  info.support_states.resize(6, 9 * places.cols());  // z_t, z_{t-1}, u_{t-1}
  Eigen::Index column = 0;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double y : {-1.0, 0.0, 1.0}) {
        const Eigen::Vector2d u(x, y);
        info.support_states.col(column++) << places.col(i).cast<float>(),
            (places.col(i) - kStep * u).cast<float>(), u.cast<float>();
      }
    }
  }
  return withInfo(model, info);
}

/// Along x from -1 to 1.
Eigen::MatrixXd line() {
  Eigen::MatrixXd places = Eigen::MatrixXd::Zero(2, 21);
  places.row(0).setLinSpaced(21, -1.0, 1.0);
  return places;
}

/// Three sides of a square, from (0, 0) to (1, 0), to (1, 1), to (0, 1).
Eigen::MatrixXd horseshoe() {
  Eigen::MatrixXd places(2, 31);
  for (int i = 0; i <= 10; ++i) {
    places.col(i) << 0.1 * i, 0.0;
    places.col(10 + i) << 1.0, 0.1 * i;
    places.col(20 + i) << 1.0 - 0.1 * i, 1.0;
  }
  return places;
}

CostToGo costTo(const Eigen::Vector2d& goal, const Ddm& model) {
  CostToGo cost(model, Eigen::Vector2d::Ones());
  cost.setGoal(goal, false);
  return cost;
}

double valueAtRest(const CostToGo& cost, const Eigen::Vector2d& z) {
  return cost.value(z, z, nullptr, nullptr);
}

TEST(CostToGo, GrowsWithTheStepsThatTheModelNeeds) {
  const CostToGo time = costTo({1.0, 0.0}, pushedModel(line()));
  for (double x = -0.9; x < 0.55; x += 0.1) {
    EXPECT_GT(valueAtRest(time, {x - 0.1, 0.0}), valueAtRest(time, {x, 0.0}) + 0.3) << x;
  }
}

TEST(CostToGo, GoesAroundAGapWhereNothingWasSeen) {
  const CostToGo time = costTo({0.0, 0.0}, pushedModel(horseshoe()));
  // the other end is nearer to the goal than the corner is, but the way leads through the corner
  EXPECT_GT(valueAtRest(time, {0.0, 1.0}), valueAtRest(time, {1.0, 1.0}) + 3.0);
  EXPECT_GT(valueAtRest(time, {1.0, 1.0}), valueAtRest(time, {1.0, 0.0}) + 3.0);
}

TEST(CostToGo, ExpectsTheWorstWhereNothingWasSeenAndMoreWhileThePlantIsExplored) {
  CostToGo time = costTo({0.0, 0.0}, pushedModel(line()));
  const double known = valueAtRest(time, {1.0, 0.0});
  EXPECT_GT(valueAtRest(time, {0.0, 3.0}), 99.0);
  EXPECT_LT(known, 60.0);
  time.setGoal(Eigen::Vector2d::Zero(), true);
  EXPECT_NEAR(valueAtRest(time, {0.0, 3.0}), 80.0, 0.8);
  EXPECT_LT(valueAtRest(time, {1.0, 0.0}), known);
  time.setGoal(Eigen::Vector2d::Zero(), false);
  EXPECT_EQ(valueAtRest(time, {1.0, 0.0}), known);
}

class PlansWithCostToGo : public ::testing::Test {
 protected:
  static constexpr int kHorizon = 7;

  /// At rest at z.
  History restingAt(const Eigen::Vector2d& z) const {
    History x(2, 2, 2);
    x.observe(z);
    return x;
  }

  const Ddm model_ = pushedModel(horseshoe());
  DdmPlanCost cost_{model_, kHorizon, 0.1, CostToGo(model_, Eigen::Vector2d::Ones())};
};

TEST_F(PlansWithCostToGo, TheGradientMatchesFiniteDifferencesFarFromTheGoalAndNearIt) {
  const Eigen::MatrixXd U = 0.3 * testing::randomMatrix(2, kHorizon, 3);
  for (const Eigen::Vector2d& z : {Eigen::Vector2d(0.9, 0.95), Eigen::Vector2d(0.2, 0.0)}) {
    cost_.setProblem(restingAt(z), Eigen::Vector2d(0.1, 0.0));
    EXPECT_TRUE(gradientMatches(&cost_, U, 1e-5)) << z.transpose();
  }
}

TEST(PlanWithCostToGo, WeighsEachTorqueAndItsChangeAtTheGoalByTheirShareOfTheLargest) {
  const Eigen::Vector2d max_torque(2.0, 0.5);
  const Ddm model = pushedModel(horseshoe(), {2.0, 0.5});
  Eigen::MatrixXd U(2, 1);
  U << 1.0, 0.5;  // half of what there is, and all
  CostToGo time(model, max_torque);
  const auto costOfStep = [&](double control_weight, double x, const Eigen::Vector2d& before) {
    const Eigen::Vector2d z(x, 0.0), goal(0.1, 0.0);
    History history(2, 2, 2);
    history.observe(z);
    history.apply(before);
    history.observe(z);
    DdmPlanCost cost(model, 1, control_weight, time);
    cost.setProblem(history, goal);
    time.setGoal(goal, false);
    const double whole = cost.evaluate(U, nullptr);
    return whole - time.value(cost.predictedFeatures().col(1), z, nullptr, nullptr);
  };
  const double width = time.stepCost().width();
  constexpr double kWeight = 0.01;
  const double effort = kWeight * (0.25 + 1.0) / (2.0 * width * width);
  for (const Eigen::Vector2d& before : {Eigen::Vector2d(U), Eigen::Vector2d(0.0, 0.0)}) {
    const double free = costOfStep(0.0, 0.1, before);
    EXPECT_LT(free, 0.7) << "at the goal, from which these torques move the features";
    const double sum = before.isZero() ? effort + 10.0 * effort : effort;
    EXPECT_NEAR(1.0 - costOfStep(kWeight, 0.1, before), (1.0 - free) * std::exp(-sum), 1e-12);
    EXPECT_NEAR(costOfStep(kWeight, 1.0, before), costOfStep(0.0, 1.0, before), 1e-3) << "far";
  }
}

/// The features of an arm that is folded to the wrong side can be so near to those of the goal.
TEST(CostToGo, AStepThatOnlyLooksLikeTheGoalCostsMoreThanHalf) {
  const CostToGo time = costTo({0.0, 0.0}, pushedModel(line()));
  const SaturatingCost& step = time.stepCost();
  EXPECT_GT(step.evaluate(Eigen::Vector2d(0.2 * step.spread(), 0.0), nullptr), 0.5);
  EXPECT_LT(step.evaluate(Eigen::Vector2d(0.05 * step.spread(), 0.0), nullptr), 0.1);
}

TEST(CostToGo, TheCostOfAStepIsHalfAsWideAsWhatThePlantMovesInOneStepButNotTooNarrow) {
  const CostToGo slow = costTo({0.0, 0.0}, pushedModel(line()));
  EXPECT_EQ(slow.stepCost().width(), CostToGo::kSmallestWidthInPlan);
  const CostToGo fast = costTo({0.0, 0.0}, pushedModel(0.25 * line()));
  const double change = kStep * std::sqrt(4.0 / 3.0);  // root mean square of the support states
  EXPECT_NEAR(fast.stepCost().width(), 0.5 * change / fast.stepCost().spread(), 1e-6);
}

TEST_F(PlansWithCostToGo, GoalAndExploringCountFromTheNextProblemOnHoweverOftenTheyChange) {
  const Eigen::MatrixXd U = Eigen::MatrixXd::Zero(2, kHorizon);
  const Eigen::Vector2d start(0.9, 0.95), goal(0.1, 0.0);
  const auto costOf = [&](DdmPlanCost* cost) {
    cost->setProblem(restingAt(start), goal);
    return cost->evaluate(U, nullptr);
  };
  const double greedy = costOf(&cost_);
  cost_.setGoal(Eigen::Vector2d(0.5, 1.0), true);
  const double exploring = costOf(&cost_);
  EXPECT_LT(exploring, greedy);
  DdmPlanCost fresh(model_, kHorizon, 0.1, CostToGo(model_, Eigen::Vector2d::Ones()));
  fresh.setGoal(goal, true);
  EXPECT_EQ(costOf(&fresh), exploring);
  cost_.setGoal(goal, false);
  EXPECT_EQ(costOf(&cost_), greedy);
}

TEST_F(PlansWithCostToGo, TheProposalLeadsOnAndIsHeldForFourSteps) {
  cost_.setProblem(restingAt({0.5, 1.0}), Eigen::Vector2d(0.5, 0.0));
  const Eigen::MatrixXd U = cost_.proposal().value();
  ASSERT_EQ(U.cols(), kHorizon);
  for (int step = 1; step < 4; ++step) EXPECT_EQ(U.col(step), U.col(0)) << step;
  EXPECT_EQ(U(0, 0), 1.0) << "to the corner, not across the gap";
  EXPECT_LT(cost_.evaluate(U, nullptr),
            cost_.evaluate(Eigen::MatrixXd::Zero(2, kHorizon), nullptr));
}

class PlansWithSaturatingCost : public PlansWithCostToGo {
 protected:
  static constexpr int kLong = 20;
  DdmPlanCost near_{model_, kLong, 0.1, SaturatingCost(model_, Eigen::Vector2d::Ones(), 0.5)};
};

TEST_F(PlansWithSaturatingCost, TheGradientMatchesFiniteDifferences) {
  near_.setProblem(restingAt({0.9, 0.95}), Eigen::Vector2d(0.1, 0.0));
  EXPECT_TRUE(gradientMatches(&near_, 0.3 * testing::randomMatrix(2, kLong, 3), 1e-5));
}

TEST_F(PlansWithSaturatingCost, TheCostIsTheSumOfTheStepsAndNothingComesAfterThem) {
  const Eigen::Vector2d goal(0.1, 0.0);
  near_.setProblem(restingAt({0.9, 0.95}), goal);
  const Eigen::MatrixXd U = Eigen::MatrixXd::Constant(2, kLong, -1.0);
  const double cost = near_.evaluate(U, nullptr);
  SaturatingCost step(model_, Eigen::Vector2d::Ones(), 0.5);
  step.setGoal(goal);
  double expected = 0.0;
  for (int k = 1; k <= kLong; ++k) {
    const double squares = k == 1 ? 2.0 + 10.0 * 2.0 : 2.0;  // the torque before the plan is 0
    const double gentle = std::exp(-0.1 * squares / (2.0 * 0.5 * 0.5));
    const double near = 1.0 - step.evaluate(near_.predictedFeatures().col(k), nullptr);
    expected += 1.0 - near * gentle;
  }
  EXPECT_NEAR(cost, expected, 1e-12 * expected);
}

TEST_F(PlansWithSaturatingCost, TheProposalIsTheBestOfAllPlansOfHeldTorques) {
  DdmPlanCost two(model_, /*horizon=*/6, 0.1, SaturatingCost(model_, Eigen::Vector2d::Ones(), 0.5));
  two.setProblem(restingAt({0.5, 0.3}), Eigen::Vector2d(0.1, 0.0), Eigen::Vector2d(0.01, -0.02));
  const Eigen::MatrixXd choices = SaturatingCost(model_, Eigen::Vector2d::Ones(), 0.5).torques();
  ASSERT_EQ(choices.cols(), 9);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 81; ++i) {
    Eigen::MatrixXd U(2, 6);
    U.leftCols(4).colwise() = choices.col(i / 9);
    U.rightCols(2).colwise() = choices.col(i % 9);
    least = std::min(least, two.evaluate(U, nullptr));
  }
  EXPECT_NEAR(two.evaluate(two.proposal().value(), nullptr), least, 1e-12);
}

/// Two decisions far from the goal cost exactly the same, whatever they are.
TEST_F(PlansWithSaturatingCost, TheProposalKeepsPlansThatAreNoBetterYet) {
  DdmPlanCost three(model_, /*horizon=*/12, 0.1,
                    SaturatingCost(model_, Eigen::Vector2d::Ones(), 0.5));
  three.setProblem(restingAt({-2.37, -2.47}), Eigen::Vector2d(0.1, 0.0));
  EXPECT_EQ(three.proposal().value(), Eigen::MatrixXd::Ones(2, 12));
}

#ifdef NDEBUG  // sanitizers take memory of their own
/// Features that hardly move, so that all support states have a weight in each of the others.
TEST(CostToGo, TakesAtMostHalfAGigabyteForTheMostMotorsAndSupportStates) {
  RandomModelOptions options;
  options.torque_dim = SaturatingCost::kMaxMotors;
  options.gain = 0.1;
  const Ddm model = withSupportStates(randomModel(options), 1000);
  const auto peakKiB = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const auto before = peakKiB();
  CostToGo time(model, Eigen::VectorXd::Ones(options.torque_dim));
  time.setGoal(Eigen::VectorXd::Zero(2), /*exploring=*/false);
  EXPECT_LT(peakKiB() - before, 500 * 1024);
}
#endif

}  // namespace
}  // namespace ddm
