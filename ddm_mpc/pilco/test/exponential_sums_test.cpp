// Tests of the sums of weighted exponentials against the plain definition.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/exponential_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "random_gp.h"

namespace ddm {
namespace pilco {
namespace {

struct Problem {
  ExponentialMatrix matrix;
  Eigen::MatrixXd weights;  // [n x n]
};

Problem randomProblem(int dim, int n, double scale, std::mt19937_64& random) {
  Problem problem;
  problem.matrix.f = normalMatrix(n, 1, scale, random);
  problem.matrix.u = normalMatrix(n, dim, scale, random);
  problem.matrix.g = normalMatrix(n, 1, scale, random);
  problem.matrix.v = normalMatrix(dim, n, 1.0, random);
  problem.matrix.column_weights = normalMatrix(n, 1, 1.0, random);
  problem.weights = normalMatrix(n, n, scale, random);
  return problem;
}

/// Relative to the sum of the absolute values, which is what rounding is proportional to.
void expectSumsOfDefinition(const Problem& problem, const Eigen::MatrixXd& weights) {
  const ExponentialMatrix& m = problem.matrix;
  Eigen::MatrixXd P = m.u * m.v;
  P.colwise() += m.f;
  P.rowwise() += m.g.transpose();
  for (Eigen::Index i = 0; i < P.size(); ++i) P(i) = std::exp(P(i));
  P = P.cwiseProduct(weights) * m.column_weights.asDiagonal();
  ExponentialSums sums;
  exponentialSums(m, &sums);
  const double tolerance = 1e-13 * P.cwiseAbs().sum();
  EXPECT_LE((sums.rows - P.rowwise().sum()).lpNorm<Eigen::Infinity>(), tolerance);
  EXPECT_LE((sums.columns - P.colwise().sum().transpose()).lpNorm<Eigen::Infinity>(), tolerance);
  EXPECT_LE((sums.moments - m.u.transpose() * P).lpNorm<Eigen::Infinity>(),
            tolerance * m.u.cwiseAbs().maxCoeff());
}

TEST(ExponentialSums, AreThoseOfTheDefinitionForEveryDimensionAndSize) {
  std::mt19937_64 random(1);
  for (const int dim : {1, 3, 4, 5, 9}) {
    for (const int n : {1, 7, 8, 30}) {
      Problem problem = randomProblem(dim, n, 1.0, random);
      problem.matrix.weights = problem.weights.data();
      problem.matrix.weight_stride = problem.weights.rows();
      SCOPED_TRACE(::testing::Message() << "dimension " << dim << ", " << n << " points");
      expectSumsOfDefinition(problem, problem.weights);
    }
  }
}

TEST(ExponentialSums, ReadOneColumnOfWeightsForAllColumnsAtStrideZero) {
  std::mt19937_64 random(2);
  Problem problem = randomProblem(4, 13, 1.0, random);
  problem.matrix.weights = problem.weights.data();
  problem.matrix.weight_stride = 0;
  expectSumsOfDefinition(problem, problem.weights.col(0).replicate(1, 13));
}

TEST(ExponentialSums, SkipOnlyWeightsThatAreZeroAboveTheDiagonal) {
  std::mt19937_64 random(3);
  for (const int n : {9, 29}) {
    Problem problem = randomProblem(4, n, 1.0, random);
    problem.weights.triangularView<Eigen::StrictlyUpper>().setZero();
    problem.matrix.weights = problem.weights.data();
    problem.matrix.weight_stride = problem.weights.rows();
    problem.matrix.lower_triangle = true;
    expectSumsOfDefinition(problem, problem.weights);
  }
}

TEST(ExponentialSums, StayExactWhereTheExponentialIsHugeOrTiny) {
  for (const double exponent : {-499.0, -300.0, -1e-9, 0.0, 1e-9, 1.0, 300.0, 700.0}) {
    Problem problem;
    problem.matrix.f = Eigen::VectorXd::Zero(1);
    problem.matrix.u = Eigen::MatrixXd::Zero(1, 1);
    problem.matrix.g = Eigen::VectorXd::Constant(1, exponent);
    problem.matrix.v = Eigen::MatrixXd::Zero(1, 1);
    problem.matrix.column_weights = Eigen::VectorXd::Ones(1);
    problem.weights = Eigen::VectorXd::Ones(1);
    problem.matrix.weights = problem.weights.data();
    ExponentialSums sums;
    exponentialSums(problem.matrix, &sums);
    EXPECT_NEAR(sums.columns[0] / std::exp(exponent), 1.0, 5e-16) << "exponent " << exponent;
  }
}

TEST(ExponentialSums, AreNextToNothingForExponentsBelowThoseThatAreExact) {
  Problem problem;
  problem.matrix.f = Eigen::VectorXd::Zero(1);
  problem.matrix.u = Eigen::MatrixXd::Zero(1, 1);
  problem.matrix.g = Eigen::VectorXd::Constant(1, -1e6);
  problem.matrix.v = Eigen::MatrixXd::Zero(1, 1);
  problem.matrix.column_weights = Eigen::VectorXd::Ones(1);
  problem.weights = Eigen::VectorXd::Ones(1);
  problem.matrix.weights = problem.weights.data();
  ExponentialSums sums;
  exponentialSums(problem.matrix, &sums);
  EXPECT_GE(sums.columns[0], 0.0);
  EXPECT_LE(sums.columns[0], 1e-200);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
