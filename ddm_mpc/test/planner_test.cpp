// Tests of the planner: bound, optimum, starts, warm start, and numerical trouble.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/planner.h"

#include <ddm_model/minimise.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <limits>

#include "ddm_msgs/testing/not_finite.h"
#include "random_model.h"

namespace ddm {
namespace {

/// Options with which the solver goes on until it is there.
MpcOptions exactOptions() {
  MpcOptions options;
  options.max_iterations = 500;
  options.function_tolerance = 0.0;
  return options;
}

RandomModelOptions firstOrder(int feature_dim) {
  RandomModelOptions options;
  options.model.order = 1;
  options.model.feature_dim = feature_dim;
  return options;
}

/// z_{t+1} = z_t + c + u_t / max_torque: an integrator that drifts.
Ddm driftingIntegrator(double drift) {
  return linearModel(firstOrder(1), Eigen::RowVector2d(1.0, 1.0),
                     Eigen::VectorXd::Constant(1, drift));
}

History stateAt(const Ddm& model, const Eigen::VectorXd& z) {
  History x(model.options().order, model.featureDim(), model.torqueDim());
  x.observe(z);
  return x;
}

double costOf(const Ddm& model, const MpcOptions& options, const History& x,
              const Eigen::VectorXd& goal, const Eigen::MatrixXd& U) {
  DdmPlanCost cost(model, options.horizon, options.control_weight);
  cost.setProblem(x, goal);
  return cost.evaluate(U, nullptr);
}

TEST(Planner, NeverExceedsTheTorqueBoundWhereverTheGoalIs) {
  silenceSolverLog();
  for (unsigned seed = 0; seed < 20; ++seed) {
    RandomModelOptions model_options;
    model_options.torque_dim = 2;
    model_options.seed = 100 * seed;
    const Ddm model = randomModel(model_options);
    MpcOptions options;
    options.max_torque = {0.7, 0.2};
    options.control_weight = 0.0;
    ModelPlanner planner(model, options);
    std::mt19937_64 rng(seed);
    for (int step = 0; step < 3; ++step) {
      const Plan plan =
          planner.solve(randomHistory(model, seed), 10.0 * testing::randomMatrix(2, 1, seed), &rng);
      ASSERT_NE(plan.status, PlanStatus::kFailed) << plan.message;
      for (int motor = 0; motor < 2; ++motor) {
        EXPECT_LE(plan.torques.row(motor).cwiseAbs().maxCoeff(), options.max_torque[motor]);
      }
    }
  }
}

TEST(Planner, RefusesLimitsForAnotherNumberOfMotors) {
  MpcOptions options;
  options.max_torque = {1.0, 2.0};
  const Ddm model = randomModel({});
  EXPECT_THROW(ModelPlanner(model, options), std::invalid_argument);
}

TEST(Planner, FindsTheClosedFormOptimumOfALinearModel) {
  Eigen::MatrixXd A(2, 3);
  A << 0.9, 0.2, 0.1, -0.2, 0.95, 0.5;  // [z, u / max_torque]
  const Eigen::Vector2d b(0.01, -0.02);
  const Ddm model = linearModel(firstOrder(2), A, b);
  const MpcOptions options = exactOptions();
  const Eigen::Vector2d z_0(0.3, -0.4), goal(0.1, 0.2);

  // z_k = free_k + sum_j G_{k,j} u_j, so J is quadratic: (G'G + lambda I) u = G' (goal - free).
  const int K = options.horizon;
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(2 * K, K);
  Eigen::VectorXd miss(2 * K);
  Eigen::Vector2d free = z_0;
  for (int k = 0; k < K; ++k) {
    free = A.leftCols(2) * free + b;
    miss.segment<2>(2 * k) = goal - free;
    Eigen::Vector2d effect = A.col(2) / model.options().max_torque[0];
    for (int j = k; j >= 0; --j) {
      G.block<2, 1>(2 * k, j) = effect;
      effect = A.leftCols(2) * effect;
    }
  }
  const Eigen::MatrixXd normal =
      G.transpose() * G + options.control_weight * Eigen::MatrixXd::Identity(K, K);
  const Eigen::VectorXd expected = normal.fullPivLu().solve(G.transpose() * miss);
  ASSERT_LT(expected.cwiseAbs().maxCoeff(), 0.9 * options.max_torque[0])
      << "the bound must not matter";

  ModelPlanner planner(model, options);
  std::mt19937_64 rng(1);
  const Plan plan = planner.solve(stateAt(model, z_0), goal, &rng);
  EXPECT_EQ(plan.status, PlanStatus::kConverged);
  EXPECT_LT((plan.torques.transpose() - expected).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Planner, ReportsCostAndFeaturesOfAPlanThatIsNoWorseThanNoTorqueOrThatOfFewerStarts) {
  MpcOptions options, one_start;
  options.num_starts = 5;
  one_start.num_starts = 1;
  for (unsigned seed = 0; seed < 10; ++seed) {  // the best start is now the first, now the last
    RandomModelOptions model_options;
    model_options.seed = seed;
    const Ddm model = randomModel(model_options);
    const History x = randomHistory(model, seed);
    ModelPlanner planner(model, options);
    std::mt19937_64 rng(seed);
    const Plan plan = planner.solve(x, model.goalFeature(), &rng);
    DdmPlanCost cost(model, options.horizon, options.control_weight);
    cost.setProblem(x, model.goalFeature());
    EXPECT_NEAR(plan.cost, cost.evaluate(plan.torques, nullptr), 1e-12);
    EXPECT_EQ(plan.features, cost.predictedFeatures());
    EXPECT_EQ(plan.goal_feature, model.goalFeature());
    EXPECT_GT(plan.iterations, 0);
    EXPECT_GE(plan.evaluations, plan.iterations);
    EXPECT_GT(plan.solve_time, 0.0);
    EXPECT_TRUE(plan.message.empty());
    EXPECT_LE(plan.cost, cost.evaluate(Eigen::MatrixXd::Zero(1, options.horizon), nullptr));
    EXPECT_LE(plan.cost, ModelPlanner(model, one_start).solve(x, model.goalFeature(), &rng).cost);
  }
}

TEST(Planner, StartsFromTheLastPlanMovedOnByOneStep) {
  // With u_0 the goal is reached, with -drift from then on it is kept: moved on by one step, this
  // plan is the optimum of the next problem, and as it stands it is not.
  const double drift = -0.2;
  const Ddm model = driftingIntegrator(drift);
  MpcOptions options = exactOptions();
  options.control_weight = 0.0;
  options.num_starts = 1;
  const Eigen::VectorXd goal = Eigen::VectorXd::Constant(1, 0.5);
  ModelPlanner warm(model, options);
  std::mt19937_64 rng(1);
  const Plan first = warm.solve(stateAt(model, Eigen::VectorXd::Zero(1)), goal, &rng);
  ASSERT_NEAR(first.torques(0, 0), 6.0 * (0.5 - drift), 1e-3);
  ASSERT_NEAR(first.torques(0, 1), -6.0 * drift, 1e-3);
  const History next = stateAt(model, first.features.col(1));
  const Plan second = warm.solve(next, goal, &rng);
  EXPECT_NEAR(second.torques(0, 0), -6.0 * drift, 1e-3);
  EXPECT_LE(second.iterations, 3);

  warm.clear();
  const Plan cold = warm.solve(next, goal, &rng);
  EXPECT_GT(cold.iterations, second.iterations + 3) << "after clear() it starts from no torque";
}

/// True from the question number `count` on.
std::function<bool()> stopAfter(int count) {
  return [count, asked = 0]() mutable { return ++asked >= count; };
}

TEST(Planner, ReturnsTheBestPlanSoFarWhenItIsStoppedAfterAnyNumberOfEvaluations) {
  const MpcOptions options = exactOptions();
  const Ddm model = randomModel({});
  const History x = randomHistory(model, 3);
  double last_cost = kInfinity;
  for (const int evaluations : {1, 2, 3, 10, 30, 100}) {
    ModelPlanner planner(model, options);
    std::mt19937_64 rng(1);
    const Plan plan = planner.solve(x, model.goalFeature(), &rng, stopAfter(evaluations));
    EXPECT_EQ(plan.status, PlanStatus::kTimeLimit) << evaluations;
    EXPECT_EQ(plan.evaluations, evaluations);
    EXPECT_NEAR(plan.cost, costOf(model, options, x, model.goalFeature(), plan.torques), 1e-12);
    EXPECT_LE(plan.cost, last_cost) << "more evaluations, and a worse plan";
    last_cost = plan.cost;
  }
  EXPECT_LT(last_cost, costOf(model, options, x, model.goalFeature(),
                              Eigen::MatrixXd::Zero(1, options.horizon)));
}

TEST(Planner, FailsOnAStateThatIsNotANumberAndPlansAgainAfterwards) {
  const Ddm model = randomModel({});
  ModelPlanner planner(model, MpcOptions());
  std::mt19937_64 rng(1);
  const History x = randomHistory(model, 3);
  EXPECT_NE(planner.solve(x, model.goalFeature(), &rng).status, PlanStatus::kFailed);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Plan failed =
      planner.solve(stateAt(model, Eigen::Vector2d(nan, 0.0)), model.goalFeature(), &rng);
  EXPECT_EQ(failed.status, PlanStatus::kFailed);
  EXPECT_FALSE(failed.message.empty());
  EXPECT_EQ(failed.torques, Eigen::MatrixXd::Zero(1, 15));
  const Plan plan = planner.solve(x, model.goalFeature(), &rng);
  EXPECT_NE(plan.status, PlanStatus::kFailed);
  EXPECT_TRUE(plan.torques.allFinite());
}

}  // namespace
}  // namespace ddm
