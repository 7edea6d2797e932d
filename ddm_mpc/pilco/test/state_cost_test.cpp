// Tests of the saturating cost and of the pendulum's cost: samples, derivatives, refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/state_cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
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

constexpr double kPi = 3.14159265358979323846;

template <class Cost>
::testing::AssertionResult costGradientMatches(const Cost& cost, const Gaussian& input) {
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

TEST(SaturatingCost, HasExpectationAndVarianceOfAMillionSamples) {
  std::mt19937_64 random(1);
  for (const int rank : {3, 1}) {
    const Eigen::VectorXd z = normalMatrix(3, 1, 0.5, random);
    const Eigen::MatrixXd W = randomWeight(3, rank, random);
    const SaturatingCost cost(z, W);
    const Gaussian input = randomGaussian(3, 3, 0.8, random);
    const double expected = cost.expected(input);
    const Eigen::MatrixXd root = squareRoot(input.covariance);
    SampleMean mean, square;
    for (int i = 0; i < 1000000; ++i) {
      const Eigen::VectorXd d = input.mean + root * normalMatrix(3, 1, 1.0, random) - z;
      const double c = 1.0 - std::exp(-0.5 * d.dot(W * d));
      mean.add(c);
      square.add((c - expected) * (c - expected));
    }
    EXPECT_LE(mean.deviation(expected), 4.0) << "rank " << rank;
    EXPECT_LE(square.deviation(cost.variance(input)), 4.0) << "rank " << rank;
  }
}

TEST(SaturatingCost, GradientMatchesDifferencesAlsoForSingularWeightAndCovariance) {
  std::mt19937_64 random(2);
  for (const int rank : {3, 1, 0}) {
    for (const int weight_rank : {3, 1}) {
      const SaturatingCost cost(normalMatrix(3, 1, 0.5, random),
                                randomWeight(3, weight_rank, random));
      EXPECT_TRUE(costGradientMatches(cost, randomGaussian(3, rank, 0.6, random)))
          << "rank " << rank << ", weight of rank " << weight_rank;
    }
  }
}

TEST(SaturatingCost, HasNoVarianceForAKnownInput) {
  const SaturatingCost cost(vectorOf({0.1, 0.2}), Eigen::MatrixXd::Identity(2, 2));
  EXPECT_EQ(cost.variance(Gaussian{vectorOf({1.0, 0.0}), Eigen::MatrixXd::Zero(2, 2)}), 0.0);
}

TEST(SaturatingCost, RefusesWeightsAndInputsThatDoNotFit) {
  const Eigen::VectorXd z = vectorOf({0.0, 0.0});
  Eigen::MatrixXd skew = Eigen::MatrixXd::Identity(2, 2);
  skew(0, 1) = 0.5;
  EXPECT_THROW(SaturatingCost(z, Eigen::MatrixXd::Identity(3, 3)), std::invalid_argument);
  EXPECT_THROW(SaturatingCost(z, skew), std::invalid_argument);
  EXPECT_THROW(SaturatingCost(Eigen::VectorXd(), Eigen::MatrixXd()), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SaturatingCost(vectorOf({nan, 0.0}), Eigen::MatrixXd::Identity(2, 2)),
               std::invalid_argument);
  std::mt19937_64 random(3);
  const SaturatingCost cost(z, Eigen::MatrixXd::Identity(2, 2));
  EXPECT_THROW(cost.expected(randomGaussian(3, 3, 1.0, random)), std::invalid_argument);
  EXPECT_THROW(cost.variance(randomGaussian(3, 3, 1.0, random)), std::invalid_argument);
}

TEST(PendulumCost, MeasuresTheDistanceOfTheTipFromTheUprightTip) {
  const StateCost cost = pendulumCost(1.0, 0.5);
  EXPECT_NEAR(cost.expected(known(vectorOf({3.0, kPi}))), 0.0, 1e-15);
  EXPECT_NEAR(cost.expected(known(vectorOf({0.0, 0.0}))), 1.0 - std::exp(-8.0), 1e-15);
  EXPECT_NEAR(cost.expected(known(vectorOf({0.0, kPi / 2.0}))), 1.0 - std::exp(-4.0), 1e-15);
  EXPECT_NEAR(cost.expected(known(vectorOf({0.0, -kPi}))), 0.0, 1e-15);
}

TEST(PendulumCost, GradientMatchesDifferences) {
  std::mt19937_64 random(4);
  for (const int rank : {2, 1, 0}) {
    Gaussian state = randomGaussian(2, rank, 0.4, random);
    state.mean[1] += kPi;
    EXPECT_TRUE(costGradientMatches(pendulumCost(0.8, 0.5), state)) << "rank " << rank;
  }
}

TEST(PendulumCost, RefusesLengthsAndFeaturesThatDoNotFit) {
  EXPECT_THROW(pendulumCost(0.0, 0.5), std::invalid_argument);
  EXPECT_THROW(pendulumCost(1.0, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(StateCost(Augmentation(2, {}, {1}),
                         SaturatingCost(Eigen::VectorXd::Zero(3), Eigen::MatrixXd::Identity(3, 3))),
               std::invalid_argument);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
