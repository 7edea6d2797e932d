// Tests of the gradient check itself: it must be able to fail.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/testing/gradient_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ddm {
namespace {

/// sum_i i sin(x_i), whose gradient can be spoilt in one entry by a factor.
DifferentiableFunction sines(Eigen::Index spoilt = -1, double factor = 1.0) {
  return [spoilt, factor](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    double value = 0.0;
    if (gradient != nullptr) gradient->resize(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double weight = static_cast<double>(i + 1);
      value += weight * std::sin(x[i]);
      if (gradient != nullptr) {
        (*gradient)[i] = weight * std::cos(x[i]) * (i == spoilt ? factor : 1.0);
      }
    }
    return value;
  };
}

const Eigen::Vector4d kPoint(0.3, -1.2, 0.8, 2.0);

TEST(GradientCheck, AcceptsAnExactGradient) {
  EXPECT_TRUE(testing::gradientMatches(sines(), kPoint));
  EXPECT_TRUE(
      testing::directionalDerivativeMatches(sines(), kPoint, Eigen::Vector4d(1.0, 2.0, 0.0, -1.0)));
}

TEST(GradientCheck, RejectsAnyEntryThatIsOnePartInAThousandOff) {
  for (Eigen::Index i = 0; i < kPoint.size(); ++i) {
    EXPECT_FALSE(testing::gradientMatches(sines(i, 1.001), kPoint)) << "entry " << i;
  }
}

TEST(GradientCheck, RejectsAnEntryThatIsTwiceTheToleranceOff) {
  EXPECT_FALSE(testing::gradientMatches(sines(2, 1.0 + 2e-6), kPoint, 1e-6));
  EXPECT_TRUE(testing::gradientMatches(sines(2, 1.0 + 5e-7), kPoint, 1e-6));
}

TEST(GradientCheck, RejectsNaNInAnyEntry) {
  for (Eigen::Index i = 0; i < kPoint.size(); ++i) {
    EXPECT_FALSE(
        testing::gradientMatches(sines(i, std::numeric_limits<double>::quiet_NaN()), kPoint))
        << "entry " << i;
  }
}

TEST(GradientCheck, RejectsAnEntryThatWasNotWritten) {
  const auto forgetful = [](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    if (gradient != nullptr) gradient->head(1) = 2.0 * x.head(1);
    return x.squaredNorm();
  };
  EXPECT_FALSE(testing::gradientMatches(forgetful, Eigen::Vector2d(1.0, 0.0)));
}

TEST(GradientCheck, RejectsAValueThatDependsOnWhetherTheGradientIsWanted) {
  const auto fickle = [](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    if (gradient == nullptr) return x.squaredNorm();
    *gradient = 2.0 * x;
    return x.squaredNorm() + 1e-9;
  };
  EXPECT_FALSE(testing::gradientMatches(fickle, Eigen::Vector2d(1.0, 2.0)));
}

TEST(GradientCheck, RejectsADirectionalDerivativeThatIsOffOrNaN) {
  const Eigen::Vector4d direction(0.0, 1.0, 0.0, 0.0);
  EXPECT_FALSE(testing::directionalDerivativeMatches(sines(1, 1.001), kPoint, direction));
  EXPECT_FALSE(testing::directionalDerivativeMatches(
      sines(1, std::numeric_limits<double>::quiet_NaN()), kPoint, direction));
}

}  // namespace
}  // namespace ddm
