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

ExponentialMatrix randomMatrix(int dim, int n, std::mt19937_64& random) {
  ExponentialMatrix matrix;
  matrix.f = normalMatrix(n, 1, 1.0, random);
  matrix.g = normalMatrix(n, 1, 1.0, random);
  matrix.u = normalMatrix(n, dim, 1.0, random);
  matrix.v = normalMatrix(dim, n, 1.0, random);
  matrix.column_weights = normalMatrix(n, 1, 1.0, random);
  return matrix;
}

/// Relative to the sum of the absolute values, which is what rounding is proportional to.
void expectSumsOfDefinition(const ExponentialMatrix& m, const ExponentialSums& sums,
                            const Eigen::MatrixXd& w) {
  Eigen::MatrixXd P = m.u * m.v;
  P.colwise() += m.f;
  P.rowwise() += m.g.transpose();
  for (Eigen::Index i = 0; i < P.size(); ++i) P(i) = std::exp(P(i));
  P = P.cwiseProduct(w) * m.column_weights.asDiagonal();
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
      SCOPED_TRACE(::testing::Message() << "dimension " << dim << ", " << n << " points");
      const ExponentialMatrix matrix = randomMatrix(dim, n, random);
      const Eigen::MatrixXd w = normalMatrix(n, n, 1.0, random);
      ExponentialSums sums;
      exponentialSums(matrix, w, &sums);
      expectSumsOfDefinition(matrix, sums, w.triangularView<Eigen::Lower>());
      exponentialSums(matrix, w.col(0), &sums);
      expectSumsOfDefinition(matrix, sums, w.col(0).replicate(1, n));
    }
  }
}

/// The sum of a single number.
double sumOfExponential(double exponent) {
  ExponentialMatrix matrix;
  matrix.f = Eigen::VectorXd::Zero(1);
  matrix.g = Eigen::VectorXd::Constant(1, exponent);
  matrix.u = Eigen::MatrixXd::Zero(1, 1);
  matrix.v = Eigen::MatrixXd::Zero(1, 1);
  matrix.column_weights = Eigen::VectorXd::Ones(1);
  ExponentialSums sums;
  exponentialSums(matrix, Eigen::VectorXd::Ones(1), &sums);
  return sums.columns[0];
}

TEST(ExponentialSums, StayExactWhereTheExponentialIsHugeOrTiny) {
  for (const double exponent : {-499.0, -300.0, -1e-9, 0.0, 1e-9, 1.0, 300.0, 700.0}) {
    EXPECT_NEAR(sumOfExponential(exponent) / std::exp(exponent), 1.0, 5e-16) << exponent;
  }
}

TEST(ExponentialSums, AreNextToNothingButNotDenormalForExponentsBelowThoseThatAreExact) {
  EXPECT_GT(sumOfExponential(-1e6), 1e-250);
  EXPECT_LE(sumOfExponential(-1e6), 1e-200);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
