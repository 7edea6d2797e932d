// Tests of the oracle: its cost, its gradient, and its control of the true plant.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/minimise.h>
#include <ddm_model/testing/gradient_check.h>
#include <ddm_model/testing/random_matrix.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <ddm_sim/plant.h>
#include <gtest/gtest.h>

#include <cmath>

#include "evaluation.h"
#include "in_process_driver.h"
#include "method.h"
#include "toy_run.h"

namespace ddm {
namespace {

using testing::randomMatrix;

constexpr double kControlWeight = 0.01;

std::unique_ptr<Plant> makePlantOf(const std::string& type) {
  return makePlant(*testing::plantOf("{type: " + type + "}"));
}

/// J(U) as a function of the flattened plan.
DifferentiableFunction costFunction(PlanCost* cost) {
  return [cost](const Eigen::VectorXd& u, Eigen::VectorXd* gradient) {
    const Eigen::Map<const Eigen::MatrixXd> U(u.data(), cost->torqueDim(), cost->horizon());
    Eigen::MatrixXd d_U;
    const double value = cost->evaluate(U, gradient != nullptr ? &d_U : nullptr);
    if (gradient != nullptr) *gradient = Eigen::Map<Eigen::VectorXd>(d_U.data(), d_U.size());
    return value;
  };
}

TEST(OracleCost, AddsUpSquaredDistancesOfTheTipAndThePriceOfTorque) {
  const std::unique_ptr<Plant> plant = makePlantOf("pendulum");
  plant->setState(Eigen::Vector2d(0.3, -0.2));
  const auto cost = makeOracleCost(*plant, makePlantOf("pendulum"), 5, kControlWeight);
  const Eigen::MatrixXd U = 3.0 * randomMatrix(1, 5, 1);
  const double J = cost->evaluate(U, nullptr);
  double expected = 0.0;
  for (int k = 0; k < 5; ++k) {
    plant->step(U.col(k));
    const double angle = plant->state()[0];
    expected += 2.0 + 2.0 * std::cos(angle) + kControlWeight * U(0, k) * U(0, k);
  }
  EXPECT_NEAR(J, expected, 1e-12);
  EXPECT_EQ(cost->predictedFeatures().cols(), 6);
  EXPECT_EQ(cost->predictedFeatures().col(5), plant->visiblePosition(plant->state()));
  EXPECT_NEAR((cost->goalFeature() - Eigen::Vector2d(0.0, 1.0)).norm(), 0.0, 1e-12);
}

TEST(OracleCost, GradientMatchesDifferencesOnEveryPlant) {
  const auto expectMatch = [](const std::string& type, const Eigen::VectorXd& state, int horizon,
                              const Eigen::VectorXd& U) {
    const std::unique_ptr<Plant> plant = makePlantOf(type);
    plant->setState(state);
    const auto cost = makeOracleCost(*plant, makePlantOf(type), horizon, kControlWeight);
    EXPECT_TRUE(testing::gradientMatches(costFunction(cost.get()), U)) << type;
  };
  expectMatch("pendulum", Eigen::Vector2d(0.4, 1.0), 6, 2.0 * randomMatrix(6, 1, 2));
  expectMatch("moving_tile", Eigen::Vector2d(20.0, 30.0), 4, randomMatrix(8, 1, 3));
  expectMatch("two_link", Eigen::Vector4d(0.4, -0.3, 1.0, 0.5), 4, randomMatrix(8, 1, 4));
}

class OracleTest : public ::testing::Test {
 protected:
  OracleTest() {
    silenceSolverLog();
    configuration_.experiment.method = "oracle";
    configuration_.trial.num_steps = 60;
  }

  TrialOutcome greedyRun(int trial) {
    InProcessDriver driver(configuration_);
    TrialRequest request;
    request.id = {7, static_cast<std::uint32_t>(trial), true};
    request.num_steps = configuration_.trial.num_steps;
    return driver.runTrial(request, [](double) {});
  }

  testing::TempFolder scratch_;
  Configuration configuration_ = testing::toyConfiguration(scratch_.file("run"));
};

TEST_F(OracleTest, StandsUpAndStaysWhereverItStarts) {
  const std::unique_ptr<Plant> plant = makePlantOf("pendulum");
  for (int trial = 0; trial < 10; ++trial) {
    const TrialOutcome run = greedyRun(trial);
    const Evaluation evaluation = evaluate(*plant, run.states, run.torques);
    EXPECT_TRUE(evaluation.success_strict) << "trial " << trial;
    EXPECT_LT(evaluation.final_error.value(), 0.1) << "trial " << trial;
  }
}

TEST_F(OracleTest, BringsACartToTheGoalOfEachRun) {
  testing::usePlant(testing::plantOf(testing::colourfulToy()), &configuration_);
  configuration_.trial.num_steps = 30;
  const std::unique_ptr<Plant> plant = makePlant(*configuration_.plant);
  for (int trial = 0; trial < 3; ++trial) {
    const TrialOutcome outcome = greedyRun(trial);
    plant->setGoal(goalOf(*plant, {7, static_cast<std::uint32_t>(trial), /*evaluation=*/true}));
    EXPECT_NE(plant->goal(), plant->info().goal);
    EXPECT_LT(plant->goalError(outcome.states.back()), 0.02) << trial;
    EXPECT_TRUE(evaluate(*plant, outcome.states, outcome.torques).success);
  }
}

TEST_F(OracleTest, LearnsNothingAndNeedsNoBag) {
  InProcessDriver driver(configuration_);
  const TrainingOutcome outcome = driver.train({"/nowhere/trial.bag"}, TrialId(), [](double) {});
  EXPECT_EQ(outcome.frames, 0u);
  EXPECT_TRUE(outcome.files.empty());
  EXPECT_FALSE(outcome.v_r.has_value());
}

}  // namespace
}  // namespace ddm
