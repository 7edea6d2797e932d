// Tests of the policies: values, samples, derivatives down to the parameters, refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/policy.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "adjoint_check.h"
#include "ddm_model/testing/vector_of.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"
#include "linear_policy.h"
#include "monte_carlo.h"
#include "random_gp.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::vectorOf;

std::unique_ptr<RbfPolicy> randomRbfPolicy(int dim, int controls, int centres,
                                           std::mt19937_64& random) {
  auto policy = std::make_unique<RbfPolicy>(dim, controls, centres);
  policy->setParameters(RbfPolicy::packParameters(normalMatrix(dim, controls, 0.2, random),
                                                  normalMatrix(dim, centres, 1.0, random),
                                                  normalMatrix(centres, controls, 0.5, random)));
  return policy;
}

std::unique_ptr<LinearPolicy> randomLinearPolicy(int dim, int controls, std::mt19937_64& random) {
  auto policy = std::make_unique<LinearPolicy>(dim, controls);
  policy->setParameters(normalMatrix(policy->numParameters(), 1, 0.7, random));
  return policy;
}

/// In the input and in the parameters.
void expectAdjointsMatch(Policy* policy, const Gaussian& input, std::mt19937_64& random) {
  EXPECT_TRUE(adjointMatches([&](const Gaussian& at) { return policy->predict(at); },
                             [&](const Gaussian& at, const Moments& d_output) {
                               return policy->backward(at, d_output, nullptr);
                             },
                             input, random));
  const Eigen::VectorXd start = policy->parameters();
  const Moments weights = randomMoments(policy->inputDim(), policy->outputDim(), random);
  const auto J = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
    policy->setParameters(parameters);
    if (gradient != nullptr) {
      gradient->setZero(parameters.size());
      policy->backward(input, weights, gradient);
    }
    return innerProduct(policy->predict(input), weights);
  };
  EXPECT_TRUE(ddm::testing::gradientMatches(J, start));
  policy->setParameters(start);
}

TEST(RbfPolicy, IsTheSumOfItsBasisFunctions) {
  std::mt19937_64 random(1);
  const Eigen::MatrixXd scales = normalMatrix(2, 1, 0.3, random);
  const Eigen::MatrixXd centres = normalMatrix(2, 4, 1.0, random);
  const Eigen::MatrixXd targets = normalMatrix(4, 1, 1.0, random);
  RbfPolicy policy(2, 1, 4);
  policy.setParameters(RbfPolicy::packParameters(scales, centres, targets));
  const auto k = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return std::exp(-0.5 * ((a - b).array() / scales.col(0).array().exp()).square().sum());
  };
  Eigen::MatrixXd A = 1e-4 * Eigen::MatrixXd::Identity(4, 4);
  Eigen::VectorXd k_x(4);
  const Eigen::VectorXd x = vectorOf({0.3, -0.4});
  for (int i = 0; i < 4; ++i) {
    k_x[i] = k(centres.col(i), x);
    for (int j = 0; j < 4; ++j) A(i, j) += k(centres.col(i), centres.col(j));
  }
  const double expected = k_x.dot(A.inverse() * targets.col(0));
  const Moments output = policy.predict(Gaussian{x, Eigen::MatrixXd::Zero(2, 2)});
  EXPECT_NEAR(output.mean[0], expected, 1e-9);
  EXPECT_NEAR(output.covariance(0, 0), 1e-6, 1e-9);
}

TEST(RbfPolicy, HoldsItsParametersAsLengthScalesCentresByCoordinateAndTargets) {
  Eigen::MatrixXd centres(2, 3);
  centres << 1, 2, 3,  //
      4, 5, 6;
  Eigen::VectorXd expected(11);
  expected << 0.1, 0.2, 1, 2, 3, 4, 5, 6, 7, 8, 9;
  EXPECT_EQ(RbfPolicy::packParameters(vectorOf({0.1, 0.2}), centres, vectorOf({7, 8, 9})),
            expected);
}

TEST(RbfPolicy, AdjointMatchesDifferencesForOneAndTwoControls) {
  std::mt19937_64 random(2);
  for (const int controls : {1, 2}) {
    for (const int rank : {3, 1, 0}) {
      SCOPED_TRACE(::testing::Message() << controls << " controls, rank " << rank);
      expectAdjointsMatch(randomRbfPolicy(3, controls, 5, random).get(),
                          randomGaussian(3, rank, 0.5, random), random);
    }
  }
}

TEST(RbfPolicy, AdjointMatchesDifferencesWhereTwoCentresCoincide) {
  std::mt19937_64 random(3);
  Eigen::MatrixXd centres = normalMatrix(2, 4, 1.0, random);
  centres.col(1) = centres.col(0);
  RbfPolicy policy(2, 1, 4);
  policy.setParameters(RbfPolicy::packParameters(normalMatrix(2, 1, 0.2, random), centres,
                                                 vectorOf({0.5, 0.5, -0.3, 0.2})));
  // K is nearly singular: differences with steps of 7e-4 would not resolve the ridge of 1e-4.
  const Gaussian input = randomGaussian(2, 2, 0.5, random);
  Moments weights = constantMoments(2, 1);
  weights.mean[0] = 1.0;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(policy.numParameters());
  policy.backward(input, weights, &gradient);
  const Eigen::VectorXd start = policy.parameters();
  const auto mean = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd*) {
    policy.setParameters(parameters);
    return policy.predict(input).mean[0];
  };
  for (int i = 0; i < start.size(); ++i) {
    const double numeric =
        ddm::testing::centralDifference(mean, start, Eigen::VectorXd::Unit(start.size(), i), 1e-4);
    EXPECT_NEAR(gradient[i], numeric, 1e-6 * gradient.lpNorm<Eigen::Infinity>()) << "entry " << i;
  }
}

TEST(RbfPolicy, PredictsNaNForParametersThatAreNotFinite) {
  std::mt19937_64 random(4);
  const auto policy = randomRbfPolicy(2, 1, 3, random);
  for (int i = 0; i < policy->numParameters(); ++i) {
    Eigen::VectorXd parameters = policy->parameters();
    parameters[i] = std::numeric_limits<double>::quiet_NaN();
    RbfPolicy broken(2, 1, 3);
    broken.setParameters(parameters);
    EXPECT_TRUE(std::isnan(broken.predict(randomGaussian(2, 2, 0.5, random)).mean[0])) << i;
  }
}

TEST(LinearPolicy, HasTheMomentsOfAMillionSamples) {
  std::mt19937_64 random(5);
  const auto policy = randomLinearPolicy(3, 2, random);
  const Gaussian input = randomGaussian(3, 3, 0.5, random);
  const Eigen::VectorXd parameters = policy->parameters();
  const Eigen::MatrixXd W = Eigen::Map<const Eigen::MatrixXd>(parameters.data(), 2, 3);
  const Eigen::VectorXd b = parameters.tail(2);
  EXPECT_TRUE(momentsMatchSamples(
      policy->predict(input), input,
      [&](const Eigen::VectorXd& x) { return Eigen::VectorXd(W * x + b); }, random));
}

TEST(LinearPolicy, AdjointMatchesDifferences) {
  std::mt19937_64 random(6);
  expectAdjointsMatch(randomLinearPolicy(3, 2, random).get(), randomGaussian(3, 2, 0.5, random),
                      random);
}

TEST(SquashedPolicy, HasTheMomentsOfAMillionSamplesAroundALinearPolicy) {
  std::mt19937_64 random(7);
  auto linear = randomLinearPolicy(2, 1, random);
  const Eigen::VectorXd w = linear->parameters();
  SquashedPolicy policy(std::move(linear), Eigen::VectorXd::Constant(1, 6.0));
  const Gaussian input = randomGaussian(2, 2, 0.7, random);
  const auto value = [&](const Eigen::VectorXd& x) {
    const double v = w[0] * x[0] + w[1] * x[1] + w[2];
    return Eigen::VectorXd::Constant(1, 6.0 * (9.0 * std::sin(v) + std::sin(3.0 * v)) / 8.0);
  };
  EXPECT_TRUE(momentsMatchSamples(policy.predict(input), input, value, random));
}

TEST(SquashedPolicy, AdjointMatchesDifferences) {
  std::mt19937_64 random(8);
  for (const int rank : {3, 0}) {
    SquashedPolicy policy(randomRbfPolicy(3, 2, 4, random), vectorOf({6.0, 0.5}));
    expectAdjointsMatch(&policy, randomGaussian(3, rank, 0.4, random), random);
  }
}

/// Before squashing about 9 between its centres: beyond five turning points of the wave.
std::unique_ptr<RbfPolicy> saturatedPolicy() {
  Eigen::MatrixXd centres(2, 6);
  centres << -0.8, 0.8, -0.8, 0.8, -0.8, 0.8,  //
      -1.6, -1.6, 0.0, 0.0, 1.6, 1.6;
  auto rbf = std::make_unique<RbfPolicy>(2, 1, 6);
  rbf->setParameters(RbfPolicy::packParameters(vectorOf({0.1, -0.1}), centres,
                                               Eigen::MatrixXd::Constant(6, 1, 9.0)));
  return rbf;
}

TEST(SquashedPolicy, AtItsBoundStaysWithinItWithRightDerivatives) {
  std::mt19937_64 random(12);
  for (const double scale : {0.0, 1e-3, 0.3, 1.0}) {
    SCOPED_TRACE(scale);
    const Gaussian input{vectorOf({0.1, -0.2}), scale * scale * Eigen::MatrixXd::Identity(2, 2)};
    EXPECT_GT(saturatedPolicy()->predict(input).mean[0], scale < 1.0 ? 8.0 : 1.0);
    SquashedPolicy policy(saturatedPolicy(), vectorOf({2.5}));
    const Moments u = policy.predict(input);
    ASSERT_TRUE(u.mean.allFinite() && u.covariance.allFinite() && u.gain.allFinite());
    EXPECT_LE(u.mean[0] * u.mean[0] + u.covariance(0, 0), 2.5 * 2.5 * (1.0 + 1e-12));
    EXPECT_GE(u.covariance(0, 0), 0.0);
    expectAdjointsMatch(&policy, input, random);
  }
}

TEST(SquashedPolicy, OnTopOfItsBoundIsFlat) {
  for (int tenths = -50; tenths <= 50; ++tenths) {
    if (tenths == 0) continue;
    const double bound = 0.1 * std::abs(tenths);
    auto linear = std::make_unique<LinearPolicy>(2, 1);
    linear->setParameters(vectorOf({0.0, 0.0, std::copysign(1.5707963267948966, tenths)}));
    SquashedPolicy policy(std::move(linear), vectorOf({bound}));
    const Gaussian input{vectorOf({0.4, -3.0}), 0.2 * Eigen::MatrixXd::Identity(2, 2)};
    EXPECT_LE(std::abs(policy.control(input.mean)[0]), bound) << "not even by a rounding error";
    EXPECT_NEAR(std::copysign(bound, tenths), policy.predict(input).mean[0], 1e-14);
    Moments seed = constantMoments(2, 1);
    seed.mean[0] = 1.0;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(3);
    const Gaussian d_input = policy.backward(input, seed, &gradient);
    EXPECT_LT(gradient.norm() + d_input.mean.norm() + d_input.covariance.norm(), 1e-13);
  }
}

TEST(SquashedPolicy, NeverCommandsMoreThanItsBoundHoweverLargeTheTargets) {
  std::mt19937_64 random(9);
  auto rbf = std::make_unique<RbfPolicy>(2, 1, 6);
  rbf->setParameters(RbfPolicy::packParameters(
      Eigen::VectorXd::Zero(2), normalMatrix(2, 6, 1.0, random), normalMatrix(6, 1, 50.0, random)));
  SquashedPolicy policy(std::move(rbf), Eigen::VectorXd::Constant(1, 2.5));
  for (int i = 0; i < 1000; ++i) {
    EXPECT_LE(std::abs(policy.control(normalMatrix(2, 1, 1.0, random))[0]), 2.5);
  }
}

TEST(Policies, RefuseSizesThatDoNotFit) {
  std::mt19937_64 random(10);
  EXPECT_THROW(RbfPolicy(2, 1, 0), std::invalid_argument);
  EXPECT_THROW(LinearPolicy(0, 1), std::invalid_argument);
  EXPECT_THROW(SquashedPolicy(nullptr, Eigen::VectorXd::Ones(1)), std::invalid_argument);
  EXPECT_THROW(SquashedPolicy(randomLinearPolicy(2, 1, random), Eigen::VectorXd::Ones(2)),
               std::invalid_argument);
  EXPECT_THROW(RbfPolicy::packParameters(Eigen::MatrixXd(2, 1), Eigen::MatrixXd(3, 4),
                                         Eigen::MatrixXd(4, 1)),
               std::invalid_argument);
  const auto refusesWrongSizes = [&](Policy* policy) {
    EXPECT_THROW(policy->setParameters(Eigen::VectorXd::Zero(policy->numParameters() + 1)),
                 std::invalid_argument);
    EXPECT_THROW(policy->predict(randomGaussian(4, 4, 1.0, random)), std::invalid_argument);
    const Gaussian input = randomGaussian(2, 2, 1.0, random);
    EXPECT_THROW(policy->backward(input, constantMoments(2, 3), nullptr), std::invalid_argument);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(1);
    EXPECT_THROW(policy->backward(input, constantMoments(2, 1), &gradient), std::invalid_argument);
  };
  refusesWrongSizes(randomRbfPolicy(2, 1, 3, random).get());
  refusesWrongSizes(randomLinearPolicy(2, 1, random).get());
  SquashedPolicy squashed(randomLinearPolicy(2, 1, random), Eigen::VectorXd::Ones(1));
  refusesWrongSizes(&squashed);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
