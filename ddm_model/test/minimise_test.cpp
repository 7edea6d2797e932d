// Tests of minimise(): it finds minima, keeps its limits, and believes nobody.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/minimise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ddm_model/testing/vector_of.h"
#include "ddm_msgs/testing/not_finite.h"

namespace ddm {
namespace {

using testing::vectorOf;

/// Rosenbrock's valley; its minimum 0 is at (1, 1).
double valley(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
  const double bend = x[1] - x[0] * x[0];
  if (gradient != nullptr) {
    *gradient = vectorOf({-400.0 * x[0] * bend - 2.0 * (1.0 - x[0]), 200.0 * bend});
  }
  return 100.0 * bend * bend + (1.0 - x[0]) * (1.0 - x[0]);
}

TEST(Minimise, FindsTheMinimumWithFullAndWithLimitedMemory) {
  for (const int rank : {0, 1, 20}) {
    MinimiseOptions options;
    options.lbfgs_rank = rank;
    const SolverResult result = minimise(valley, vectorOf({-1.2, 1.0}), options);
    EXPECT_TRUE(result.improved() && result.converged());
    EXPECT_NEAR(24.2, result.initial_cost, 1e-10);
    EXPECT_LT((result.x - vectorOf({1.0, 1.0})).norm(), 1e-5);
    EXPECT_EQ(valley(result.x, nullptr), result.cost);
    EXPECT_LT(result.gradient.norm(), 1e-4);
    EXPECT_GE(result.evaluations, result.iterations);
  }
}

TEST(Minimise, StoringAllStepsGivesTheStepsOfBfgs) {
  MinimiseOptions bfgs, all_steps;
  bfgs.max_iterations = all_steps.max_iterations = all_steps.lbfgs_rank = 12;
  const SolverResult expected = minimise(valley, vectorOf({-1.2, 1.0}), bfgs);
  const SolverResult result = minimise(valley, vectorOf({-1.2, 1.0}), all_steps);
  EXPECT_LT((result.x - expected.x).norm(), 1e-9);
  EXPECT_EQ(result.evaluations, expected.evaluations);

  all_steps.lbfgs_rank = 1;  // the comparison notices steps that are not stored
  EXPECT_GT((minimise(valley, vectorOf({-1.2, 1.0}), all_steps).x - expected.x).norm(), 1e-6);
}

TEST(Minimise, KeepsItsLimitsAndReturnsTheBestSoFar) {
  MinimiseOptions options;
  options.max_iterations = 4;
  const SolverResult few = minimise(valley, vectorOf({-1.2, 1.0}), options);
  EXPECT_EQ(4, few.iterations);
  EXPECT_TRUE(few.improved());
  EXPECT_FALSE(few.converged());
  EXPECT_EQ(TerminationReason::kIterationLimit, few.reason);
  EXPECT_NE(std::string::npos, few.message.find("iterations")) << few.message;

  int calls = 0;
  const auto counting = [&calls](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    ++calls;
    return valley(x, gradient);
  };
  options.max_iterations = 100;
  options.max_evaluations = 9;
  const SolverResult capped = minimise(counting, vectorOf({-1.2, 1.0}), options);
  EXPECT_EQ(9, calls);
  EXPECT_EQ(9, capped.evaluations);
  EXPECT_TRUE(capped.improved());
  EXPECT_FALSE(capped.converged());
  EXPECT_EQ(TerminationReason::kEvaluationLimit, capped.reason);
  EXPECT_NE(std::string::npos, capped.message.find("evaluations")) << capped.message;
  EXPECT_EQ(valley(capped.x, nullptr), capped.cost);
}

TEST(Minimise, SurvivesPointsThatCannotBeEvaluated) {
  for (bool bad_gradient : {false, true}) {
    int failures = 0;
    // x - log(x) / 100: next to no curvature, so that BFGS jumps beyond 0.
    const auto walled = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
      if (gradient != nullptr) *gradient = 1.0 - 0.01 * x.array().inverse();
      if (x[0] > 0.0) return x[0] - 0.01 * std::log(x[0]);
      ++failures;
      if (bad_gradient && gradient != nullptr) gradient->setConstant(kNaN);
      return bad_gradient ? -1.0 : kNaN;
    };
    const Eigen::VectorXd start = Eigen::VectorXd::Constant(1, 5.0);
    const SolverResult result = minimise(walled, start, MinimiseOptions());
    EXPECT_TRUE(result.improved());
    EXPECT_NEAR(0.01, result.x[0], 1e-5) << result.message;
    EXPECT_GT(failures, 0) << "the wall was never met: the test shows nothing";
  }
}

TEST(Minimise, SaysThatTheStartCannotBeEvaluated) {
  const auto nowhere = [](const Eigen::VectorXd&, Eigen::VectorXd*) { return kNaN; };
  const SolverResult result = minimise(nowhere, vectorOf({3.0, 4.0}), MinimiseOptions());
  EXPECT_EQ(TerminationReason::kStartFailed, result.reason);
  EXPECT_FALSE(result.improved() || result.converged());
  EXPECT_EQ(kInfinity, result.cost);
  EXPECT_EQ(vectorOf({3.0, 4.0}), result.x);
  EXPECT_NE(std::string::npos, result.message.find("evaluated")) << result.message;
  EXPECT_EQ(TerminationReason::kStartFailed,
            minimise(valley, vectorOf({0.0, kNaN}), MinimiseOptions()).reason);
}

TEST(Minimise, ClaimsNoImprovementAtTheMinimum) {
  const SolverResult result = minimise(valley, vectorOf({1.0, 1.0}), MinimiseOptions());
  EXPECT_FALSE(result.improved());
  EXPECT_TRUE(result.converged());
  EXPECT_EQ(result.initial_cost, result.cost);
}

TEST(Minimise, DoesNotCallItConvergedWhereNoStepHelpsThoughThereIsASlope) {
  const auto stuck = [](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    if (gradient != nullptr) *gradient = vectorOf({-3.0});  // but it is flat
    return 5.0 + std::abs(x[0]);
  };
  MinimiseOptions options;
  for (options.function_tolerance = 1e-10; options.function_tolerance < 1.0;
       options.function_tolerance *= 1e10) {
    const SolverResult result = minimise(stuck, vectorOf({0.0}), options);
    EXPECT_FALSE(result.improved());
    EXPECT_FALSE(result.converged());
    EXPECT_EQ(TerminationReason::kNoDecrease, result.reason);
    EXPECT_NE(std::string::npos, result.message.find("magnitude 3")) << result.message;
  }
}

TEST(Minimise, EndsByTheChangeOfTheCostWhateverItsSign) {
  // x^4, nowhere steep: the search comes closer by a factor each time and ends by the cost only.
  const Eigen::VectorXd start = vectorOf({1.0, -0.8});
  const double at_start = start.array().square().square().sum();
  for (const double offset : {1.0, -1.0, -at_start}) {  // the last one: the cost starts at 0
    const auto quartic = [offset](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
      if (gradient != nullptr) *gradient = 4.0 * x.array().cube();
      return offset + x.array().square().square().sum();
    };
    MinimiseOptions options;
    options.gradient_tolerance = 0.0;
    options.function_tolerance = 1e-4;
    const SolverResult loose = minimise(quartic, start, options);
    options.function_tolerance = 1e-10;
    const SolverResult tight = minimise(quartic, start, options);
    for (const SolverResult* result : {&loose, &tight}) {
      EXPECT_TRUE(result->improved() && result->converged()) << result->message;
      EXPECT_LT(result->iterations, 60);
    }
    EXPECT_LT(loose.iterations, tight.iterations) << "offset " << offset;
    EXPECT_NEAR(offset, loose.cost, 1e-3);
    EXPECT_NEAR(offset, tight.cost, 1e-8);
  }
}

TEST(Minimise, AsksForPermissionBeforeEachEvaluationAndNeverAgainOnceItIsRefused) {
  const SolverResult whole = minimise(valley, vectorOf({-1.2, 1.0}), MinimiseOptions());
  double best = kInfinity;
  for (int allowed = 0; allowed < whole.evaluations; ++allowed) {
    int evaluations = 0, asked = 0;
    const auto counting = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
      ++evaluations;
      EXPECT_EQ(evaluations, asked);
      return valley(x, gradient);
    };
    MinimiseOptions options;
    options.stop = [&] { return ++asked > allowed; };
    const SolverResult result = minimise(counting, vectorOf({-1.2, 1.0}), options);
    EXPECT_EQ(allowed, evaluations);
    EXPECT_EQ(allowed + 1, asked);
    EXPECT_EQ(allowed, result.evaluations);
    EXPECT_EQ(TerminationReason::kStopped, result.reason) << result.message;
    EXPECT_LE(result.cost, best);
    best = result.cost;
    EXPECT_EQ(allowed > 0 ? valley(result.x, nullptr) : kInfinity, result.cost);
    if (allowed == 0) {
      EXPECT_EQ(vectorOf({-1.2, 1.0}), result.x);
    }
  }
}

}  // namespace
}  // namespace ddm
