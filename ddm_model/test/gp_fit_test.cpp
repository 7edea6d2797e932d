// Tests of the Gaussian process in f: its likelihood, and what it learns.
// SPDX-License-Identifier: BSD-3-Clause
#include "gp_fit.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "ddm_model/testing/gradient_check.h"
#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace {

using testing::randomMatrix;

/// Two outputs that depend on the first two of three inputs.
Transitions exampleOf(Eigen::Index count, unsigned seed) {
  Transitions out{randomMatrix(3, count, seed), Eigen::MatrixXd(2, count)};
  out.changes.row(0) = (1.5 * out.regressors.row(0).array()).sin();
  out.changes.row(1) = 10.0 * out.regressors.row(0).array() * out.regressors.row(1).array();
  return out;
}

Eigen::MatrixXd predict(const Eigen::VectorXd& theta, const Eigen::MatrixXd& inputs) {
  const GpMean<double> gp = GpMean<double>::ofSize(3, 2, theta.size());
  Mlp<double>::Tape tape;
  gp.forward(theta.data(), inputs, &tape);
  return tape.output();
}

Eigen::VectorXd fit(const Transitions& transitions, unsigned seed = 1,
                    Eigen::Index max_centres = kMaxCentres) {
  std::mt19937_64 rng(seed);
  return fitGp(
      transitions, &rng, [] {}, max_centres);
}

TEST(GpLikelihood, EqualsTheFormulaAtTheMeanOfThePrior) {
  const Eigen::MatrixXd X = randomMatrix(2, 6, 1), Y = randomMatrix(3, 6, 2);
  const double scale = std::sqrt(2.0), noise = 0.3 * 0.3 + 1e-8;
  Eigen::MatrixXd K(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      K(i, j) = std::exp(-0.5 * (X.col(i) - X.col(j)).squaredNorm() / (scale * scale)) +
                (i == j ? noise : 0.0);
    }
  }
  const double expected =
      0.5 * (Y * K.inverse() * Y.transpose()).trace() + 3.0 * 0.5 * std::log(K.determinant());
  const Eigen::Vector4d p(std::log(scale), std::log(scale), 0.0, std::log(0.3));
  EXPECT_NEAR(negativeLogLikelihood(X, Y)(p, nullptr), expected, 1e-9 * std::abs(expected));
}

TEST(GpLikelihood, GradientMatchesDifferences) {
  const auto f = negativeLogLikelihood(randomMatrix(3, 20, 1), randomMatrix(2, 20, 2));
  EXPECT_TRUE(testing::gradientMatches(f, 0.5 * randomMatrix(5, 1, 3)));
}

TEST(FitGp, PredictsAndFindsTheInputsThatCount) {
  const Eigen::VectorXd theta = fit(exampleOf(200, 1));
  const Transitions test = exampleOf(100, 2);
  const Eigen::MatrixXd inside =
      test.regressors.cwiseMax(-1.5).cwiseMin(1.5);  // between the samples
  Transitions clipped{inside, Eigen::MatrixXd(2, 100)};
  clipped.changes.row(0) = (1.5 * inside.row(0).array()).sin();
  clipped.changes.row(1) = 10.0 * inside.row(0).array() * inside.row(1).array();
  const Eigen::MatrixXd errors = predict(theta, inside) - clipped.changes;
  for (int row = 0; row < 2; ++row) {
    EXPECT_LT(errors.row(row).norm(), 0.1 * clipped.changes.row(row).norm()) << "output " << row;
  }
  EXPECT_GT(theta[1], 4.0 * theta[2]) << "1 / l of an input that does not count";
}

TEST(FitGp, AveragesOverNoiseWithFewerCentresThanSamples) {
  Transitions noisy = exampleOf(600, 1);
  noisy.changes += 0.3 * randomMatrix(2, 600, 5);
  const Eigen::VectorXd theta = fit(noisy);
  EXPECT_LT((theta.size() - 11) / 5, 60) << "centres";
  const Transitions test = exampleOf(200, 2);
  const Eigen::MatrixXd errors = predict(theta, test.regressors) - test.changes;
  EXPECT_LT(errors.row(0).norm() / std::sqrt(200.0), 0.2) << "the noise has 0.3";
}

TEST(WithoutOutliers, KeepsTheRestAsItIs) {
  const Transitions clean = exampleOf(200, 1);
  Transitions all = clean;
  for (Eigen::Index i = 0; i < 200; i += 20) all.changes.col(i) += Eigen::Vector2d(4.0, -30.0);
  std::mt19937_64 rng(1);
  const Transitions kept = withoutOutliers(all, &rng, [] {});
  EXPECT_GE(kept.changes.cols(), 180);
  EXPECT_LE(kept.changes.cols(), 190) << "190 transitions are no outliers";
  Eigen::Index found = 0;
  for (Eigen::Index i = 0; i < 200 && found < kept.changes.cols(); ++i) {  // in their order
    if (kept.regressors.col(found) != clean.regressors.col(i)) continue;
    EXPECT_EQ(kept.changes.col(found), clean.changes.col(i)) << "transition " << i;
    ++found;
  }
  EXPECT_EQ(found, kept.changes.cols());
}

TEST(WithoutOutliers, TakesSmallErrorsForRounding) {
  Transitions exact{randomMatrix(3, 200, 1), Eigen::MatrixXd(2, 200)};
  exact.changes << exact.regressors.row(0), exact.regressors.row(1);
  exact.changes(0, 7) += 0.02;
  std::mt19937_64 rng(1);
  EXPECT_EQ(withoutOutliers(exact, &rng, [] {}).changes.cols(), 200);
}

TEST(FitGp, IsLinearFarFromAllSamples) {
  Transitions linear{randomMatrix(3, 100, 1), Eigen::MatrixXd(2, 100)};
  Eigen::MatrixXd slope(2, 3);
  slope << 1, -2, 0, 0, 3, 0.5;
  linear.changes = (slope * linear.regressors).colwise() + Eigen::Vector2d(4, 5);
  const Eigen::Vector3d far(200, 100, -300);
  EXPECT_TRUE(predict(fit(linear), far).isApprox(slope * far + Eigen::Vector2d(4, 5), 0.01));
}

TEST(FitGp, OneDrawGivesOneResultWithAtMostSoManyCentres) {
  const Transitions many = exampleOf(420, 1);  // more than the likelihood takes
  const Eigen::VectorXd theta = fit(many, 1, /*max_centres=*/10);
  EXPECT_EQ(theta.size(), GpMean<double>(3, 2, 10).numParams());
  EXPECT_EQ(fit(many, 1, 10), theta);
  EXPECT_NE(fit(many, 2, 10).head(3), theta.head(3)) << "1 / l";
}

TEST(FitGp, RefusesNoTransitionsAndStopsWhenItIsCancelled) {
  EXPECT_THROW(fit({Eigen::MatrixXd(3, 0), Eigen::MatrixXd(2, 0)}), std::invalid_argument);
  std::mt19937_64 rng(1);
  const auto cancel = [] { throw std::runtime_error("cancelled"); };
  EXPECT_THROW(fitGp(exampleOf(50, 1), &rng, cancel), std::runtime_error);
}

TEST(FitGp, TakesAnInputThatNeverChanges) {
  Transitions constant = exampleOf(50, 1);
  constant.regressors.row(2).setConstant(7.0);
  EXPECT_TRUE(fit(constant).allFinite());
}

TEST(Transitions, StayWithinSegments) {
  ModelOptions options;
  options.order = 3;
  options.predictor = "gp";
  const PredictionModel<double> f(options, 1);
  DataSet data(2, 1);
  for (int t = 0; t < 9; ++t) {
    data.append(Image(4), Eigen::VectorXd::Constant(1, t), /*new_segment=*/t == 0 || t == 4);
  }
  Eigen::MatrixXd Z(2, 9);
  Z.row(0) << -3, 0, 1, 4, 99, 100, 101, 104, 109;
  Z.row(1) = -Z.row(0);
  const Transitions found = transitionsOf(f, Z, data);
  ASSERT_EQ(found.changes.cols(), 3);  // 1 -> 2, 4 -> 5, 5 -> 6
  EXPECT_EQ(found.changes.row(0), Eigen::RowVector3d(3, 3, 5));
  EXPECT_EQ(found.regressors.row(0), Eigen::RowVector3d(1, 101, 104)) << "z_t";
  EXPECT_TRUE(found.regressors.row(2).isApprox(Eigen::RowVector3d(2, 6, 7) / 6.0)) << "u_t";
  EXPECT_EQ(found.regressors.row(3), Eigen::RowVector3d(1, 1, 3)) << "z_t - z_{t-1}";
  EXPECT_TRUE(found.regressors.row(5).isApprox(Eigen::RowVector3d(1, 5, 6) / 6.0)) << "u_{t-1}";
  EXPECT_TRUE(found.regressors.row(6).isApprox(Eigen::RowVector3d(0, 4, 5) / 6.0)) << "u_{t-2}";
}

}  // namespace
}  // namespace ddm
