// Tests of the policy search.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/policy_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ddm_model/testing/vector_of.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/not_finite.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::names;
using ::ddm::testing::throwsNaming;
using ::ddm::testing::vectorOf;

/// A cost that saturates like the expected costs do; its minimum 0 is at (2, 2, 2).
double saturating(const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
  const Eigen::VectorXd away = x.array() - 2.0;
  const double near = std::exp(-0.1 * away.squaredNorm());
  if (gradient != nullptr) *gradient = 0.2 * near * away;
  return 1.0 - near;
}

TEST(PolicySearch, FindsTheBestParametersAndReportsBothCosts) {
  const Eigen::VectorXd start = vectorOf({0.0, 4.0, 1.0});
  const Minimum result = searchPolicy(saturating, start, PolicySearchOptions());
  EXPECT_TRUE(result.improved());
  EXPECT_EQ(saturating(start, nullptr), result.initial_cost);
  EXPECT_EQ(saturating(result.x, nullptr), result.cost);
  EXPECT_LT((result.x.array() - 2.0).abs().maxCoeff(), 1e-3);
  EXPECT_GT(result.iterations, 0);
  EXPECT_GE(result.evaluations, result.iterations);
  EXPECT_EQ("converged", result.message);
}

TEST(PolicySearch, KeepsItsLimits) {
  PolicySearchOptions options;
  options.max_iterations = 1;
  const Eigen::VectorXd start = vectorOf({0.0, 4.0, 1.0});
  EXPECT_EQ(1, searchPolicy(saturating, start, options).iterations);
  options.max_iterations = 75;
  options.max_evaluations = 2;
  const Minimum result = searchPolicy(saturating, start, options);
  EXPECT_EQ(2, result.evaluations);
  EXPECT_EQ(MinimumReason::kEvaluationLimit, result.reason);
}

TEST(PolicySearch, SurvivesAPolicyWhosePredictionDiverges) {
  const auto diverging = [](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const double value = saturating(x, gradient);
    return x[0] > 2.0 ? kNaN : value;
  };
  const Minimum result = searchPolicy(diverging, vectorOf({0.0, 4.0, 1.0}), PolicySearchOptions());
  EXPECT_TRUE(result.improved());
  EXPECT_LT(result.cost, 0.1 * result.initial_cost) << result.message;
}

TEST(PolicySearch, KeepsAPolicyThatCannotBeEvaluated) {
  const auto nowhere = [](const Eigen::VectorXd&, Eigen::VectorXd*) { return kNaN; };
  const Eigen::VectorXd start = vectorOf({1.0, 2.0, 3.0});
  const Minimum result = searchPolicy(nowhere, start, PolicySearchOptions());
  EXPECT_EQ(MinimumReason::kStartFailed, result.reason);
  EXPECT_FALSE(result.improved());
  EXPECT_EQ(start, result.x);
  EXPECT_NE("", result.message);
}

TEST(PolicySearchOptions, AllProblemsAreReportedAndNaNIsOne) {
  EXPECT_TRUE(PolicySearchOptions().problems().empty());
  PolicySearchOptions options;
  options.max_iterations = -1;
  options.max_evaluations = 0;
  options.function_tolerance = kNaN;
  ASSERT_EQ(3u, options.problems().size());
  EXPECT_TRUE(names(options.problems()[1], {"policy_search/max_evaluations", ">= 1", "got 0"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { searchPolicy(saturating, Eigen::VectorXd::Zero(3), options); }, {"policy_search/"}));
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
