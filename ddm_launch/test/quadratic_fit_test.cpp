// Tests of the quadratic fit: what it explains, and what it cannot.
// SPDX-License-Identifier: BSD-3-Clause
#include "quadratic_fit.h"

#include <ddm_model/testing/random_matrix.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace ddm {
namespace {

using testing::randomMatrix;

Eigen::MatrixXd bent(const Eigen::MatrixXd& x) {
  Eigen::MatrixXd y(2, x.cols());
  y.row(0) = (1.0 + 2.0 * x.row(0).array() - x.row(0).array() * x.row(1).array()).matrix();
  y.row(1) = (x.row(1).array().square() - 0.5 * x.row(0).array().square()).matrix();
  return y;
}

TEST(QuadraticFit, ExplainsAQuadraticMapWhollyOnOtherSamplesToo) {
  const Eigen::MatrixXd x = randomMatrix(2, 50, 1);
  const QuadraticFit fit(x, bent(x));
  EXPECT_NEAR(fit.explained(x, bent(x)), 1.0, 1e-12);
  const Eigen::MatrixXd others = 3.0 * randomMatrix(2, 50, 2);
  EXPECT_NEAR(fit.explained(others, bent(others)), 1.0, 1e-12);
}

TEST(QuadraticFit, ExplainsNothingOfWhatHasNothingToDoWithIt) {
  const Eigen::MatrixXd x = randomMatrix(2, 5000, 1);
  const Eigen::MatrixXd y = randomMatrix(2, 5000, 2);
  const QuadraticFit fit(x, y);
  EXPECT_LT(fit.explained(x, y), 0.01);
  EXPECT_LT(fit.explained(randomMatrix(2, 5000, 3), randomMatrix(2, 5000, 4)), 0.0);
}

TEST(QuadraticFit, ExplainsTheShareOfTheVarianceThatIsNotNoise) {
  const Eigen::MatrixXd x = randomMatrix(1, 20000, 1);
  const Eigen::MatrixXd noise = randomMatrix(1, 20000, 2);  // as large as x
  const QuadraticFit fit(x, x + noise);
  EXPECT_NEAR(fit.explained(x, x + noise), 0.5, 0.02);
}

TEST(QuadraticFit, MeasuresWhatIsLeftAgainstTheSpreadOfTheSamplesAsked) {
  Eigen::MatrixXd x(1, 4);
  x << -1.0, 0.0, 1.0, 2.0;
  const QuadraticFit fit(x, x);  // the identity
  Eigen::MatrixXd y(1, 4);
  y << 0.0, 0.0, 0.0, 4.0;  // residuals 1, 0, 1, 2; spread around the mean 1: 1, 1, 1, 3
  EXPECT_NEAR(fit.explained(x, y), 1.0 - 6.0 / 12.0, 1e-12);
}

TEST(QuadraticFit, RefusesToExplainWhatDoesNotVary) {
  const Eigen::MatrixXd x = randomMatrix(2, 50, 1);
  const QuadraticFit fit(x, bent(x));
  EXPECT_THROW(fit.explained(x, Eigen::MatrixXd::Ones(2, 50)), std::invalid_argument);
}

TEST(QuadraticFit, RefusesSamplesThatDoNotPairUp) {
  EXPECT_THROW(QuadraticFit(randomMatrix(2, 5, 1), randomMatrix(2, 6, 1)), std::invalid_argument);
  EXPECT_THROW(QuadraticFit(Eigen::MatrixXd(2, 0), Eigen::MatrixXd(2, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
