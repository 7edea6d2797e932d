// Tests of the policies: values, samples, derivatives with respect to inputs and parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/policy.h"

#include <ddm_model/testing/vector_of.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "random_problems.h"

namespace ddm::pilco {
namespace {

using ::ddm::testing::vectorOf;

RbfPolicy randomRbfPolicy(int dim, int controls, int centres, std::mt19937_64& random) {
  RbfPolicy policy(dim, controls, centres);
  policy.setParameters(RbfPolicy::packParameters(normalMatrix(dim, controls, 0.2, random),
                                                 normalMatrix(dim, centres, 1.0, random),
                                                 normalMatrix(centres, controls, 0.5, random)));
  return policy;
}

/// Checks the derivatives with respect to the input and the parameters.
template <class Policy>
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

TEST(RbfPolicy, AdjointMatchesDifferencesForOneAndTwoControls) {
  std::mt19937_64 random(2);
  for (const int controls : {1, 2}) {
    for (const int rank : {3, 1, 0}) {
      SCOPED_TRACE(::testing::Message() << controls << " controls, rank " << rank);
      RbfPolicy policy = randomRbfPolicy(3, controls, 5, random);
      expectAdjointsMatch(&policy, randomGaussian(3, rank, 0.5, random), random);
    }
  }
}

TEST(Squashing, HasTheMomentsOfSamples) {
  std::mt19937_64 random(1);
  const Squashing squashing(vectorOf({6.0, 2.5}));
  const Gaussian input = randomGaussian(2, 2, 0.9, random);
  const auto value = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(
        (Eigen::Array2d(6.0, 2.5) * (9.0 * x.array().sin() + (3.0 * x.array()).sin()) / 8.0));
  };
  EXPECT_TRUE(momentsMatchSamples(squashing.predict(input), input, value, random));
}

/// A policy whose output before squashing is about 9 between its centres, i.e. beyond five turning
/// points of the wave.
RbfPolicy saturatedPolicy() {
  Eigen::MatrixXd centres(2, 6);
  centres << -0.8, 0.8, -0.8, 0.8, -0.8, 0.8,  //
      -1.6, -1.6, 0.0, 0.0, 1.6, 1.6;
  RbfPolicy rbf(2, 1, 6);
  rbf.setParameters(RbfPolicy::packParameters(vectorOf({0.1, -0.1}), centres,
                                              Eigen::MatrixXd::Constant(6, 1, 9.0)));
  return rbf;
}

TEST(SquashedPolicy, AtItsBoundStaysWithinItWithRightDerivatives) {
  std::mt19937_64 random(12);
  for (const double scale : {0.0, 1e-3, 0.3, 1.0}) {
    SCOPED_TRACE(scale);
    const Gaussian input{vectorOf({0.1, -0.2}), scale * scale * Eigen::MatrixXd::Identity(2, 2)};
    EXPECT_GT(saturatedPolicy().predict(input).mean[0], scale < 1.0 ? 8.0 : 1.0);
    SquashedPolicy policy(saturatedPolicy(), vectorOf({2.5}));
    const Moments u = policy.predict(input);
    ASSERT_TRUE(u.mean.allFinite() && u.covariance.allFinite() && u.gain.allFinite());
    EXPECT_LE(u.mean[0] * u.mean[0] + u.covariance(0, 0), 2.5 * 2.5 * (1.0 + 1e-12));
    EXPECT_GE(u.covariance(0, 0), 0.0);
    expectAdjointsMatch(&policy, input, random);
  }
}

TEST(SquashedPolicy, NeverCommandsMoreThanItsBoundHoweverLargeTheTargets) {
  std::mt19937_64 random(9);
  RbfPolicy rbf(2, 1, 6);
  rbf.setParameters(RbfPolicy::packParameters(
      Eigen::VectorXd::Zero(2), normalMatrix(2, 6, 1.0, random), normalMatrix(6, 1, 50.0, random)));
  SquashedPolicy policy(std::move(rbf), Eigen::VectorXd::Constant(1, 2.5));
  for (int i = 0; i < 1000; ++i) {
    EXPECT_LE(std::abs(policy.control(normalMatrix(2, 1, 1.0, random))[0]), 2.5);
  }
}

}  // namespace
}  // namespace ddm::pilco
