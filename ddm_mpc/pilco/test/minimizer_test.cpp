// Tests of the minimiser.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/minimizer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ddm_model/testing/expect_error.h"
#include "vector_of.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::throwsNaming;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Rosenbrock's valley; its minimum 0 is at (1, 1).
double valley(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
  const double bend = x[1] - x[0] * x[0];
  if (gradient != nullptr) {
    *gradient = vectorOf({-400.0 * x[0] * bend - 2.0 * (1.0 - x[0]), 200.0 * bend});
  }
  return 100.0 * bend * bend + (1.0 - x[0]) * (1.0 - x[0]);
}

TEST(Minimizer, FindsTheMinimumWithFullAndWithLimitedMemory) {
  for (bool limited_memory : {false, true}) {
    MinimizerOptions options;
    options.limited_memory = limited_memory;
    const Minimum minimum = minimize(valley, vectorOf({-1.2, 1.0}), options);
    EXPECT_TRUE(minimum.start_ok);
    EXPECT_TRUE(minimum.improved);
    EXPECT_TRUE(minimum.converged);
    EXPECT_EQ("converged", minimum.message);
    EXPECT_NEAR(24.2, minimum.initial_cost, 1e-10);
    EXPECT_LT((minimum.x - vectorOf({1.0, 1.0})).norm(), 1e-5);
    EXPECT_EQ(valley(minimum.x, nullptr), minimum.cost);
    EXPECT_LT(minimum.gradient.norm(), 1e-4);
    EXPECT_GE(minimum.evaluations, minimum.iterations);
  }
}

TEST(Minimizer, KeepsItsLimitsAndReturnsTheBestSoFar) {
  MinimizerOptions options;
  options.max_iterations = 4;
  const Minimum few = minimize(valley, vectorOf({-1.2, 1.0}), options);
  EXPECT_EQ(4, few.iterations);
  EXPECT_TRUE(few.improved);
  EXPECT_FALSE(few.converged);
  EXPECT_EQ("limit of iterations reached", few.message);

  int calls = 0;
  const auto counting = [&calls](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    ++calls;
    return valley(x, gradient);
  };
  options.max_iterations = 100;
  options.max_evaluations = 9;
  const Minimum capped = minimize(counting, vectorOf({-1.2, 1.0}), options);
  EXPECT_EQ(9, calls);
  EXPECT_EQ(9, capped.evaluations);
  EXPECT_TRUE(capped.improved);
  EXPECT_FALSE(capped.converged);
  EXPECT_EQ("limit of evaluations reached", capped.message);
  EXPECT_EQ(valley(capped.x, nullptr), capped.cost);
}

TEST(Minimizer, NeverReturnsAWorsePointForOneMoreEvaluation) {
  double last_evaluated = 0.0;
  const auto watched = [&last_evaluated](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    return last_evaluated = valley(x, gradient);
  };
  MinimizerOptions options;
  double best = valley(vectorOf({-1.2, 1.0}), nullptr);
  int ended_uphill = 0;
  for (options.max_evaluations = 1; options.max_evaluations <= 30; ++options.max_evaluations) {
    const Minimum minimum = minimize(watched, vectorOf({-1.2, 1.0}), options);
    EXPECT_LE(minimum.cost, best);
    EXPECT_FALSE(minimum.converged) << "refused evaluations are no convergence";
    EXPECT_EQ(valley(minimum.x, nullptr), minimum.cost);
    if (last_evaluated > minimum.cost) ++ended_uphill;
    best = minimum.cost;
  }
  EXPECT_GT(ended_uphill, 0) << "the last point was always the best: the test shows nothing";
}

TEST(Minimizer, SurvivesPointsThatCannotBeEvaluated) {
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
    const Minimum minimum = minimize(walled, start, MinimizerOptions());
    EXPECT_TRUE(minimum.improved);
    EXPECT_NEAR(0.01, minimum.x[0], 1e-5) << minimum.message;
    EXPECT_GT(failures, 0) << "the wall was never met: the test shows nothing";
  }
}

TEST(Minimizer, SaysThatTheStartCannotBeEvaluated) {
  const auto nowhere = [](const Eigen::VectorXd&, Eigen::VectorXd*) { return kNaN; };
  const Minimum minimum = minimize(nowhere, vectorOf({3.0, 4.0}), MinimizerOptions());
  EXPECT_FALSE(minimum.start_ok);
  EXPECT_FALSE(minimum.improved);
  EXPECT_EQ(vectorOf({3.0, 4.0}), minimum.x);
  EXPECT_EQ("the function cannot be evaluated at the start", minimum.message);
}

TEST(Minimizer, ClaimsNoImprovementWhereThereIsNone) {
  const Minimum at_optimum = minimize(valley, vectorOf({1.0, 1.0}), MinimizerOptions());
  EXPECT_FALSE(at_optimum.improved);
  EXPECT_TRUE(at_optimum.converged);
  EXPECT_EQ("converged", at_optimum.message);
  EXPECT_EQ(at_optimum.initial_cost, at_optimum.cost);

  const auto uphill = [](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const double value = valley(x, gradient);
    if (gradient != nullptr) *gradient = -*gradient;  // a gradient that lies
    return value;
  };
  const Minimum misled = minimize(uphill, vectorOf({-1.2, 1.0}), MinimizerOptions());
  EXPECT_LE(misled.cost, misled.initial_cost);
  EXPECT_EQ(misled.cost < misled.initial_cost, misled.improved);
}

TEST(Minimizer, DoesNotCallItConvergedWhereNoStepHelpsThoughThereIsASlope) {
  const auto stuck = [](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    if (gradient != nullptr) *gradient = vectorOf({-3.0});  // but it is flat
    return 5.0 + std::abs(x[0]);
  };
  MinimizerOptions options;
  for (options.function_tolerance = 1e-10; options.function_tolerance < 1.0;
       options.function_tolerance *= 1e10) {
    const Minimum minimum = minimize(stuck, vectorOf({0.0}), options);
    EXPECT_FALSE(minimum.improved);
    EXPECT_FALSE(minimum.converged);
    EXPECT_NE(std::string::npos, minimum.message.find("no step lowers the cost"))
        << minimum.message;
    EXPECT_NE(std::string::npos, minimum.message.find("magnitude 3")) << minimum.message;
  }
}

TEST(Minimizer, EndsByTheChangeOfTheCostWhateverItsSign) {
  // x^4, nowhere steep: the search comes closer by a factor each time and ends by the cost only.
  const Eigen::VectorXd start = vectorOf({1.0, -0.8});
  const double at_start = start.array().square().square().sum();
  for (const double offset : {1.0, -1.0, -at_start}) {  // the last one: the cost starts at 0
    const auto quartic = [offset](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
      if (gradient != nullptr) *gradient = 4.0 * x.array().cube();
      return offset + x.array().square().square().sum();
    };
    MinimizerOptions options;
    options.gradient_tolerance = 0.0;
    options.function_tolerance = 1e-4;
    const Minimum loose = minimize(quartic, start, options);
    options.function_tolerance = 1e-10;
    const Minimum tight = minimize(quartic, start, options);
    for (const Minimum* minimum : {&loose, &tight}) {
      EXPECT_TRUE(minimum->improved && minimum->converged) << minimum->message;
      EXPECT_LT(minimum->iterations, 60);
    }
    EXPECT_LT(loose.iterations, tight.iterations) << "offset " << offset;
    EXPECT_NEAR(offset, loose.cost, 1e-3);
    EXPECT_NEAR(offset, tight.cost, 1e-8);
  }
}

TEST(Minimizer, RefusesAStartThatIsEmptyOrNotFinite) {
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [] { minimize(valley, Eigen::VectorXd(), MinimizerOptions()); }, {"start", "none"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [] {
        minimize(valley, vectorOf({0.0, kNaN}), MinimizerOptions());
      },
      {"finite"}));
  MinimizerOptions options;
  options.max_iterations = -1;
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] {
        minimize(valley, vectorOf({0.0, 0.0}), options);
      },
      {">= 0"}));
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
