// Tests of sines and cosines of a Gaussian: samples, derivatives, limits, refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/trigonometric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "adjoint_check.h"
#include "ddm_model/testing/vector_of.h"
#include "monte_carlo.h"
#include "random_gp.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::vectorOf;

::testing::AssertionResult augmentationAdjointMatches(const Augmentation& augmentation,
                                                      const Gaussian& input,
                                                      std::mt19937_64& random) {
  return adjointMatches([&](const Gaussian& at) { return augmentation.predict(at); },
                        [&](const Gaussian& at, const Moments& d_output) {
                          return augmentation.backward(at, d_output);
                        },
                        input, random);
}

TEST(Augmentation, HasTheMomentsOfAMillionSamples) {
  std::mt19937_64 random(1);
  const Augmentation augmentation(3, {1}, {2, 0}, {0.7, 2.0});
  const Gaussian input = randomGaussian(3, 3, 0.8, random);
  const auto value = [](const Eigen::VectorXd& x) {
    Eigen::VectorXd y(5);
    y << x[1], 0.7 * std::sin(x[2]), 0.7 * std::cos(x[2]), 2.0 * std::sin(x[0]),
        2.0 * std::cos(x[0]);
    return y;
  };
  EXPECT_TRUE(momentsMatchSamples(augmentation.predict(input), input, value, random));
}

TEST(Augmentation, GivesTheValueItselfForAKnownInput) {
  const Augmentation augmentation(2, {0, 1}, {1});
  const Eigen::VectorXd expected = vectorOf({0.4, -1.3, std::sin(-1.3), std::cos(-1.3)});
  EXPECT_LE((augmentation.value(vectorOf({0.4, -1.3})) - expected).norm(), 1e-15);
  const Moments output =
      augmentation.predict(Gaussian{vectorOf({0.4, -1.3}), Eigen::MatrixXd::Zero(2, 2)});
  EXPECT_EQ(output.covariance.norm(), 0.0);
}

TEST(Augmentation, KeepsSineAndCosineOnTheCircleInTheMeanOfTheirSquares) {
  std::mt19937_64 random(2);
  const Moments output = Augmentation(1, {}, {0}).predict(randomGaussian(1, 1, 1.5, random));
  EXPECT_NEAR(output.mean.squaredNorm() + output.covariance.trace(), 1.0, 1e-15);
}

TEST(Augmentation, StaysFiniteForAnAngleAboutWhichNothingIsKnown) {
  const Gaussian input{vectorOf({0.3, 1.0}), 5e3 * Eigen::MatrixXd::Ones(2, 2)};
  const Moments output = Augmentation(2, {0}, {0, 1}).predict(input);
  ASSERT_TRUE(output.mean.allFinite() && output.covariance.allFinite() && output.gain.allFinite());
  EXPECT_NEAR(output.covariance(1, 1), 0.5, 1e-12);
  EXPECT_NEAR(output.covariance(1, 3), 0.5 * std::cos(0.7), 1e-12);  // fully correlated
}

TEST(Augmentation, AdjointMatchesDifferences) {
  std::mt19937_64 random(3);
  for (const int rank : {3, 1, 0}) {
    const Gaussian input = randomGaussian(3, rank, 0.6, random);
    EXPECT_TRUE(augmentationAdjointMatches(Augmentation(3, {}, {1}), input, random));
    EXPECT_TRUE(
        augmentationAdjointMatches(Augmentation(3, {2, 0}, {2, 0}, {0.5, 3.0}), input, random));
    EXPECT_TRUE(augmentationAdjointMatches(Augmentation(3, {0, 1, 2}, {}), input, random));
  }
}

TEST(Augmentation, ReplacesAnglesBehindTheOtherEntries) {
  const Eigen::VectorXd x = vectorOf({0.1, 0.2, 0.3});
  const Eigen::VectorXd expected = vectorOf({0.1, 0.3, std::sin(0.2), std::cos(0.2)});
  EXPECT_LE((replaceAngles(3, {1}).value(x) - expected).norm(), 1e-15);
  EXPECT_EQ(replaceAngles(3, {}).value(x), x);
}

TEST(Augmentation, RefusesIndicesAndSizesThatDoNotFit) {
  EXPECT_THROW(Augmentation(2, {2}, {}), std::invalid_argument);
  EXPECT_THROW(Augmentation(2, {}, {-1}), std::invalid_argument);
  EXPECT_THROW(Augmentation(2, {}, {}), std::invalid_argument);
  EXPECT_THROW(Augmentation(2, {}, {0, 1}, {1.0}), std::invalid_argument);
  std::mt19937_64 random(4);
  const Augmentation augmentation(2, {0}, {1});
  EXPECT_THROW(augmentation.predict(randomGaussian(3, 3, 1.0, random)), std::invalid_argument);
  EXPECT_THROW(augmentation.backward(randomGaussian(2, 2, 1.0, random), constantMoments(2, 2)),
               std::invalid_argument);
}

TEST(SineCovariance, IsExactForVariancesNearTheSmallestNumbers) {
  // cov(sin a, sin b) -> c cos m_a cos m_b; e^c - 1 by subtraction would leave no digit of it.
  const double c = 1e-20;
  EXPECT_NEAR(sineCovariance(0.3, 0.8, c, c, c) / (c * std::cos(0.3) * std::cos(0.8)), 1.0, 1e-14);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
