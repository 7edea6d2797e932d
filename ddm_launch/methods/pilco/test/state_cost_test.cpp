// Tests of the features of a state with angles and of its cost: samples, derivatives, limits.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/state_cost.h"

#include <ddm_model/testing/vector_of.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "random_problems.h"

namespace ddm::pilco {
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

TEST(Augmentation, HasTheMomentsOfSamples) {
  std::mt19937_64 random(1);
  const Augmentation augmentation(3, {1}, {2, 0});
  const Gaussian input = randomGaussian(3, 3, 0.8, random);
  const auto value = [](const Eigen::VectorXd& x) {
    Eigen::VectorXd y(5);
    y << x[1], std::sin(x[2]), std::cos(x[2]), std::sin(x[0]), std::cos(x[0]);
    return y;
  };
  EXPECT_TRUE(momentsMatchSamples(augmentation.predict(input), input, value, random));
}

TEST(Augmentation, StaysFiniteForAnAngleAboutWhichNothingIsKnown) {
  const Gaussian input{vectorOf({0.3, 1.0}), 5e3 * Eigen::MatrixXd::Ones(2, 2)};
  const Moments output = Augmentation(2, {0}, {0, 1}).predict(input);
  ASSERT_TRUE(output.mean.allFinite() && output.covariance.allFinite() && output.gain.allFinite());
  EXPECT_NEAR(output.covariance(1, 1), 0.5, 1e-12);
  // the two angles are fully correlated
  EXPECT_NEAR(output.covariance(1, 3), 0.5 * std::cos(0.7), 1e-12);
}

TEST(Augmentation, AdjointMatchesDifferences) {
  std::mt19937_64 random(3);
  for (const int rank : {3, 1, 0}) {
    const Gaussian input = randomGaussian(3, rank, 0.6, random);
    EXPECT_TRUE(augmentationAdjointMatches(Augmentation(3, {}, {1}), input, random));
    EXPECT_TRUE(augmentationAdjointMatches(Augmentation(3, {2, 0}, {2, 0}), input, random));
    EXPECT_TRUE(augmentationAdjointMatches(Augmentation(3, {0, 1, 2}, {}), input, random));
  }
}

TEST(SineCovariance, IsExactForVariancesNearTheSmallestNumbers) {
  // cov(sin a, sin b) is c cos m_a cos m_b for c -> 0. Computing e^c - 1 by subtraction would lose
  // all digits.
  const double c = 1e-20;
  EXPECT_NEAR(sineCovariance(0.3, 0.8, c, c, c) / (c * std::cos(0.3) * std::cos(0.8)), 1.0, 1e-14);
}

constexpr double kPi = 3.14159265358979323846;

::testing::AssertionResult costGradientMatches(const StateCost& cost, const Gaussian& input) {
  const int dim = static_cast<int>(input.mean.size());
  const auto expected = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Gaussian at = unflatten(x, dim);
    if (gradient == nullptr) return cost.expected(at);
    Gaussian d_input;
    const double value = cost.expected(at, &d_input);
    *gradient = flatten(d_input);
    return value;
  };
  return ddm::testing::gradientMatches(expected, flatten(input));
}

Eigen::MatrixXd randomWeight(int dim, int rank, std::mt19937_64& random) {
  const Eigen::MatrixXd root = normalMatrix(dim, rank, 0.7, random);
  return root * root.transpose();
}

TEST(StateCost, HasExpectationAndVarianceOfSamples) {
  std::mt19937_64 random(1);
  for (const int rank : {3, 1}) {
    const Eigen::VectorXd z = normalMatrix(3, 1, 0.5, random);
    const Eigen::MatrixXd W = randomWeight(3, rank, random);
    const StateCost cost(replaceAngles(3, {}), z, W);
    const Gaussian input = randomGaussian(3, 3, 0.8, random);
    const double expected = cost.expected(input);
    const Eigen::MatrixXd root = squareRoot(input.covariance);
    const auto draw = [&] {
      const Eigen::VectorXd d = input.mean + root * normalMatrix(3, 1, 1.0, random) - z;
      const double c = 1.0 - std::exp(-0.5 * d.dot(W * d));
      return Eigen::Array2d(c, (c - expected) * (c - expected));
    };
    EXPECT_TRUE(meansMatchSamples(Eigen::Array2d(expected, cost.variance(input)), draw))
        << "rank " << rank;
  }
}

TEST(StateCost, GradientMatchesDifferencesAlsoForSingularWeightAndCovariance) {
  std::mt19937_64 random(2);
  for (const int rank : {3, 1, 0}) {
    for (const int weight_rank : {3, 1}) {
      const StateCost cost(replaceAngles(3, {}), normalMatrix(3, 1, 0.5, random),
                           randomWeight(3, weight_rank, random));
      EXPECT_TRUE(costGradientMatches(cost, randomGaussian(3, rank, 0.6, random)))
          << "rank " << rank << ", weight of rank " << weight_rank;
    }
  }
}

TEST(PendulumCost, MeasuresTheDistanceOfTheTipFromTheUprightTip) {
  const StateCost cost = pendulumCost(1.0, 0.5);
  EXPECT_NEAR(cost.expected(known(vectorOf({3.0, kPi}))), 0.0, 1e-15);
  EXPECT_NEAR(cost.expected(known(vectorOf({0.0, 0.0}))), 1.0 - std::exp(-8.0), 1e-15);
  EXPECT_NEAR(cost.expected(known(vectorOf({0.0, kPi / 2.0}))), 1.0 - std::exp(-4.0), 1e-15);
  EXPECT_NEAR(cost.expected(known(vectorOf({0.0, -kPi}))), 0.0, 1e-15);
}

}  // namespace
}  // namespace ddm::pilco
