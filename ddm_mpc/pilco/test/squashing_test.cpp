// Tests of the squashing: range, samples, derivatives, refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "adjoint_check.h"
#include "ddm_model/testing/vector_of.h"
#include "ddm_pilco/squashed_policy.h"
#include "monte_carlo.h"
#include "random_gp.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::vectorOf;

TEST(Squashing, StaysInItsRangeButForRoundingAndReachesIt) {
  const Squashing squashing(vectorOf({6.0, 0.3}));
  double largest = 0.0;
  for (int i = -2000; i <= 2000; ++i) {
    const Gaussian known{Eigen::VectorXd::Constant(2, 0.005 * i), Eigen::MatrixXd::Zero(2, 2)};
    const Eigen::VectorXd u = squashing.predict(known).mean;
    EXPECT_LE(std::abs(u[0]), 6.0 * (1.0 + 1e-15));
    EXPECT_LE(std::abs(u[1]), 0.3 * (1.0 + 1e-15));
    largest = std::max(largest, u[0]);
  }
  EXPECT_NEAR(largest, 6.0, 1e-6);
}

TEST(Squashing, HasTheMomentsOfAMillionSamples) {
  std::mt19937_64 random(1);
  const Squashing squashing(vectorOf({6.0, 2.5}));
  const Gaussian input = randomGaussian(2, 2, 0.9, random);
  const auto value = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(
        (Eigen::Array2d(6.0, 2.5) * (9.0 * x.array().sin() + (3.0 * x.array()).sin()) / 8.0));
  };
  EXPECT_TRUE(momentsMatchSamples(squashing.predict(input), input, value, random));
}

TEST(Squashing, AdjointMatchesDifferences) {
  std::mt19937_64 random(2);
  for (const int rank : {2, 1, 0}) {
    const Squashing squashing(vectorOf({6.0, 2.5}));
    EXPECT_TRUE(adjointMatches([&](const Gaussian& at) { return squashing.predict(at); },
                               [&](const Gaussian& at, const Moments& d_output) {
                                 return squashing.backward(at, d_output);
                               },
                               randomGaussian(2, rank, 0.5, random), random))
        << "rank " << rank;
  }
}

TEST(Squashing, RefusesBoundsThatAreNotPositiveAndInputsOfAnotherSize) {
  EXPECT_THROW(Squashing(Eigen::VectorXd(0)), std::invalid_argument);
  EXPECT_THROW(Squashing(vectorOf({1.0, 0.0})), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Squashing(vectorOf({nan, 1.0})), std::invalid_argument);
  std::mt19937_64 random(3);
  const Squashing squashing(Eigen::VectorXd::Ones(1));
  EXPECT_THROW(squashing.predict(randomGaussian(2, 2, 1.0, random)), std::invalid_argument);
  EXPECT_THROW(squashing.backward(randomGaussian(1, 1, 1.0, random), constantMoments(1, 2)),
               std::invalid_argument);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
