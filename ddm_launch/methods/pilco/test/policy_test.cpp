// Tests of the policies: values, samples, derivatives with respect to inputs and parameters.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/policy.h"

#include <ddm_model/testing/vector_of.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "random_problems.h"

namespace ddm::pilco {
namespace {

using ::ddm::testing::vectorOf;

/// Checks the derivatives with respect to the input and the parameters.
void expectAdjointsMatch(RbfPolicy* policy, const Gaussian& input, std::mt19937_64& random) {
  Eigen::VectorXd unused = policy->parameters();
  EXPECT_TRUE(adjointMatches([&](const Gaussian& at) { return policy->predict(at); },
                             [&](const Gaussian& at, const Moments& d_output) {
                               return policy->backward(at, d_output, &unused);
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
  RbfPolicy policy(2, 4, vectorOf({1.0}));
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
  const Moments output = policy.predictUnsquashed(known(x));
  EXPECT_NEAR(output.mean[0], expected, 1e-9);
  EXPECT_NEAR(output.covariance(0, 0), 1e-6, 1e-9);
}

TEST(RbfPolicy, AdjointMatchesDifferencesForOneAndTwoControls) {
  std::mt19937_64 random(2);
  for (const int controls : {1, 2}) {
    for (const int rank : {3, 1, 0}) {
      SCOPED_TRACE(::testing::Message() << controls << " controls, rank " << rank);
      RbfPolicy policy(3, 5, vectorOf({2.0, 0.5}).head(controls));
      policy.setParameters(RbfPolicy::packParameters(normalMatrix(3, controls, 0.2, random),
                                                     normalMatrix(3, 5, 1.0, random),
                                                     normalMatrix(5, controls, 0.5, random)));
      expectAdjointsMatch(&policy, randomGaussian(3, rank, 0.5, random), random);
    }
  }
}

TEST(Squashing, HasTheMomentsOfSamples) {
  std::mt19937_64 random(1);
  const Gaussian input = randomGaussian(2, 2, 0.9, random);
  const auto value = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(
        (Eigen::Array2d(6.0, 2.5) * (9.0 * x.array().sin() + (3.0 * x.array()).sin()) / 8.0));
  };
  EXPECT_TRUE(momentsMatchSamples(squash(input, vectorOf({6.0, 2.5})), input, value, random));
}

/// A policy whose output before squashing is about 9 between its centres, i.e. beyond five turning
/// points of the wave.
RbfPolicy saturatedPolicy() {
  Eigen::MatrixXd centres(2, 6);
  centres << -0.8, 0.8, -0.8, 0.8, -0.8, 0.8,  //
      -1.6, -1.6, 0.0, 0.0, 1.6, 1.6;
  RbfPolicy policy(2, 6, vectorOf({2.5}));
  policy.setParameters(RbfPolicy::packParameters(vectorOf({0.1, -0.1}), centres,
                                                 Eigen::MatrixXd::Constant(6, 1, 9.0)));
  return policy;
}

TEST(RbfPolicy, AtItsBoundStaysWithinItWithRightDerivatives) {
  std::mt19937_64 random(12);
  for (const double scale : {0.0, 1e-3, 0.3, 1.0}) {
    SCOPED_TRACE(scale);
    const Gaussian input{vectorOf({0.1, -0.2}), scale * scale * Eigen::MatrixXd::Identity(2, 2)};
    RbfPolicy policy = saturatedPolicy();
    EXPECT_GT(policy.predictUnsquashed(input).mean[0], scale < 1.0 ? 8.0 : 1.0);
    const Moments u = policy.predict(input);
    ASSERT_TRUE(u.mean.allFinite() && u.covariance.allFinite() && u.gain.allFinite());
    EXPECT_LE(u.mean[0] * u.mean[0] + u.covariance(0, 0), 2.5 * 2.5 * (1.0 + 1e-12));
    EXPECT_GE(u.covariance(0, 0), 0.0);
    expectAdjointsMatch(&policy, input, random);
  }
}

TEST(RbfPolicy, NeverCommandsMoreThanItsBoundHoweverLargeTheTargets) {
  std::mt19937_64 random(9);
  RbfPolicy policy(2, 6, vectorOf({2.5}));
  policy.setParameters(RbfPolicy::packParameters(
      Eigen::VectorXd::Zero(2), normalMatrix(2, 6, 1.0, random), normalMatrix(6, 1, 50.0, random)));
  for (int i = 0; i < 1000; ++i) {
    EXPECT_LE(std::abs(policy.control(normalMatrix(2, 1, 1.0, random))[0]), 2.5);
  }
}

}  // namespace
}  // namespace ddm::pilco
