// Tests of full and sparse GPs: likelihoods, training, and the choice between full and sparse.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/gp.h"

#include <ddm_model/testing/gradient_check.h>
#include <ddm_model/testing/random_matrix.h>
#include <ddm_model/testing/vector_of.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/not_finite.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace ddm::pilco {
namespace {

using ::ddm::testing::gradientMatches;
using ::ddm::testing::names;
using ::ddm::testing::randomMatrix;
using ::ddm::testing::throwsNaming;
using ::ddm::testing::vectorOf;

constexpr int kIterations = 300;

/// A smooth function of three inputs with noise of standard deviation 0.05. The function does not
/// depend on the third input.
struct Toy {
  explicit Toy(int n, unsigned seed = 1) : inputs(randomMatrix(3, n, seed)), targets(n, 2) {
    const Eigen::ArrayXd x = inputs.row(0), y = inputs.row(1);
    targets.col(0) = (1.5 * x).sin() + 0.5 * y;
    targets.col(1) = (x + y).cos();
    targets += 0.05 * randomMatrix(n, 2, seed + 1);
  }
  Eigen::MatrixXd inputs;
  Eigen::MatrixXd targets;
};

Eigen::VectorXd someTheta() {
  Eigen::VectorXd theta(5);
  theta << 0.3, -0.2, 0.6, 0.4, -1.7;
  return theta;
}

TEST(NegativeLogLikelihood, IsThatOfAMultivariateNormal) {
  const Toy toy(6);
  const Eigen::VectorXd theta = someTheta();
  Eigen::MatrixXd a(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const Eigen::Array3d difference = toy.inputs.col(i) - toy.inputs.col(j);
      const Eigen::Array3d l = theta.head(3).array().exp();
      a(i, j) = std::exp(2.0 * theta[3] - 0.5 * (difference / l).square().sum());
    }
    a(i, i) += std::exp(2.0 * theta[4]);
  }
  const Eigen::VectorXd y = toy.targets.col(0);
  const double density = std::exp(-0.5 * y.dot(a.inverse() * y)) /
                         std::sqrt(std::pow(2.0 * M_PI, 6) * a.determinant());
  EXPECT_NEAR(-std::log(density), negativeLogLikelihood(toy.inputs, y, theta), 1e-10);
}

TEST(NegativeLogLikelihood, GradientMatchesDifferences) {
  const Toy toy(25);
  for (int output = 0; output < 2; ++output) {
    const auto f = [&](const Eigen::VectorXd& theta, Eigen::VectorXd* gradient) {
      return negativeLogLikelihood(toy.inputs, toy.targets.col(output), theta, gradient);
    };
    EXPECT_TRUE(gradientMatches(f, someTheta(), 1e-8)) << "output " << output;
  }
}

TEST(NegativeLogLikelihood, IsInfiniteWherePositiveDefinitenessIsLost) {
  Eigen::MatrixXd inputs = Eigen::MatrixXd::Zero(3, 4);  // the same point four times
  Eigen::VectorXd theta = someTheta();
  theta[4] = -30.0;  // and almost no noise
  Eigen::VectorXd gradient;
  EXPECT_EQ(std::numeric_limits<double>::infinity(),
            negativeLogLikelihood(inputs, vectorOf({1, 2, 3, 4}), theta, &gradient));
  EXPECT_EQ(5, gradient.size());
  EXPECT_FALSE(gradient.allFinite());
  theta[4] = kNaN;
  EXPECT_EQ(std::numeric_limits<double>::infinity(),
            negativeLogLikelihood(inputs, vectorOf({1, 2, 3, 4}), theta));
}

TEST(Penalty, IsOneWhereALimitIsReachedAndNothingFarInsideAndItsGradientMatchesDifferences) {
  const Eigen::VectorXd input_std = vectorOf({2.0, 0.1});
  Eigen::VectorXd theta(4);
  theta << std::log(2.0), std::log(0.1), 0.0, -1.0;
  EXPECT_LT(penalty(theta, input_std), 1e-20);
  theta[0] = std::log(200.0);
  EXPECT_NEAR(1.0, penalty(theta, input_std), 1e-12);
  theta[1] = std::log(0.001);
  EXPECT_NEAR(2.0, penalty(theta, input_std), 1e-12);
  theta[2] = std::log(1000.0) - 1.0;
  EXPECT_NEAR(3.0, penalty(theta, input_std), 1e-12);
  const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    if (gradient != nullptr) *gradient = x;  // gradient of the first term
    return 0.5 * x.squaredNorm() + penalty(x, input_std, gradient);
  };
  theta << std::log(190.0), std::log(9.0), 3.0, -3.8;  // near the limits
  EXPECT_TRUE(gradientMatches(f, theta, 1e-6));
}

TEST(TrainGp, EndsAtAnOptimumThatKnowsNoiseAndRelevance) {
  const Toy toy(80);
  const GpFit fit = trainGp(toy.inputs, toy.targets, kIterations);
  ASSERT_TRUE(fit.ok()) << fit.message;
  EXPECT_EQ("", fit.message);
  ASSERT_EQ(2u, fit.outputs.size());
  for (int output = 0; output < 2; ++output) {
    EXPECT_LT(fit.outputs[output].cost, fit.outputs[output].initial_cost - 1.0);
    EXPECT_LT(fit.outputs[output].gradient.norm(), 1e-4);
    EXPECT_LE(fit.outputs[output].iterations, 300);
    EXPECT_GE(fit.outputs[output].evaluations, fit.outputs[output].iterations);
    EXPECT_NEAR(0.05, std::exp(fit.model.hyperparameters(4, output)), 0.02);
    EXPECT_GT(fit.model.hyperparameters(2, output), std::log(5.0));  // length-scale of input 3
  }
  const Eigen::VectorXd theta = fit.model.hyperparameters.col(1);
  const double expected = negativeLogLikelihood(toy.inputs, toy.targets.col(1), theta) +
                          penalty(theta, sampleStd(toy.inputs));
  EXPECT_NEAR(expected, fit.outputs[1].cost, 1e-9 * std::abs(expected));
}

TEST(TrainGp, TrainsAnewAndSaysSoWhereThePreviousOptimumCannotBeEvaluated) {
  Toy toy(20);
  toy.inputs.col(3) = toy.inputs.col(5);
  Hyperparameters bad = initialHyperparameters(toy.inputs, toy.targets);
  bad(4, 1) = -40.0;
  const GpFit fit = trainGp(toy.inputs, toy.targets, kIterations, bad);
  ASSERT_TRUE(fit.ok()) << fit.message;
  EXPECT_TRUE(names(fit.message, {"output 2: ", "previous hyper-parameters"}));
}

TEST(TrainGp, TellsThatTheLikelihoodCannotBeEvaluatedAtAll) {
  Toy toy(20);
  toy.targets.col(1) *= 1e-161;  // rounding hides its noise variance
  const GpFit fit = trainGp(toy.inputs, toy.targets, kIterations);
  EXPECT_FALSE(fit.ok());
  EXPECT_TRUE(names(fit.message, {"output 2: ", "likelihood"}));
  EXPECT_EQ(0, fit.model.numPoints());
}

TEST(TrainGp, RefusesDataItCannotLearnFromAndNamesThem) {
  const Toy toy(10);
  const auto refused = [](const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                          const std::vector<std::string>& parts) {
    return throwsNaming<std::invalid_argument>([&] { trainGp(inputs, targets, kIterations); },
                                               parts);
  };
  Eigen::MatrixXd changed = toy.inputs;
  changed(1, 6) = kNaN;
  EXPECT_TRUE(refused(changed, toy.targets, {"input 2 of point 7", "finite", "nan"}));
  changed = toy.inputs;
  changed.row(2).setConstant(0.1);
  EXPECT_TRUE(refused(changed, toy.targets, {"input 3 is 0.1", "all 10 points", "images"}));
  changed = toy.targets;
  changed(3, 1) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused(toy.inputs, changed, {"target 2 of point 4", "finite", "inf"}));
  EXPECT_TRUE(refused(toy.inputs, 1e200 * toy.targets, {"target 1", "too large"}));
  EXPECT_TRUE(refused(toy.inputs.leftCols(1), toy.targets.topRows(1), {" 2 points", "got 1"}));
}

/// The toy problem with two inputs and with given hyper-parameters.
struct SparseToy : Toy {
  explicit SparseToy(int n) : Toy(n) {
    inputs = inputs.topRows(2).eval();
    hyperparameters.resize(4, 2);
    hyperparameters << 0.1, 0.3, 0.8, 0.2, 0.3, 0.1, -2.0, -1.5;
  }
  Hyperparameters hyperparameters;
};

/// Matrices of one output, computed literally from the formulas with matrix inverses.
struct PlainFitc {
  PlainFitc(const SparseToy& toy, const Eigen::MatrixXd& inducing, int output) {
    const Eigen::VectorXd theta = toy.hyperparameters.col(output);
    const Eigen::VectorXd l = theta.head(2).array().exp();
    const double sf = std::exp(theta[2]);
    k_mn = squaredExponential(inducing, toy.inputs, l, sf);
    k_mm = squaredExponential(inducing, inducing, l, sf);
    k_mm.diagonal().array() += kRidge;
    const Eigen::MatrixXd q = k_mn.transpose() * k_mm.inverse() * k_mn;
    lambda = std::exp(2.0 * theta[3]) + sf * sf - q.diagonal().array();
    c = q;
    c.diagonal() += lambda.matrix();
  }
  Eigen::MatrixXd k_mn, k_mm, c;
  Eigen::ArrayXd lambda;
};

TEST(SparseLikelihood, IsThatOfAMultivariateNormalSummedOverOutputs) {
  const SparseToy toy(12);
  const Eigen::MatrixXd inducing = randomMatrix(2, 4, 3);
  double expected = 0.0;
  for (int output = 0; output < 2; ++output) {
    const PlainFitc plain(toy, inducing, output);
    const Eigen::VectorXd y = toy.targets.col(output);
    expected += 0.5 * y.dot(plain.c.inverse() * y) + 0.5 * std::log(plain.c.determinant()) +
                6.0 * std::log(2.0 * M_PI);
  }
  EXPECT_NEAR(expected,
              sparseNegativeLogLikelihood(inducing, toy.inputs, toy.targets, toy.hyperparameters),
              1e-8);
}

TEST(SparseLikelihood, GradientInTheInducingInputsMatchesDifferences) {
  const SparseToy toy(15);
  const Eigen::MatrixXd inducing = randomMatrix(2, 5, 3);
  const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Eigen::MatrixXd z = Eigen::Map<const Eigen::MatrixXd>(x.data(), 2, 5);
    Eigen::MatrixXd d_z;
    const double value = sparseNegativeLogLikelihood(
        z, toy.inputs, toy.targets, toy.hyperparameters, gradient != nullptr ? &d_z : nullptr);
    if (gradient != nullptr) *gradient = Eigen::Map<const Eigen::VectorXd>(d_z.data(), 10);
    return value;
  };
  EXPECT_TRUE(gradientMatches(f, Eigen::Map<const Eigen::VectorXd>(inducing.data(), 10), 1e-7));
}

TEST(SparseGpModel, HasTheMatricesOfTheFormulas) {
  const SparseToy toy(14);
  const Eigen::MatrixXd inducing = randomMatrix(2, 5, 3);
  const GpFit fit = makeSparseGpModel(inducing, toy.inputs, toy.targets, toy.hyperparameters);
  ASSERT_TRUE(fit.ok()) << fit.message;
  EXPECT_EQ(inducing, fit.model.inputs);
  for (int output = 0; output < 2; ++output) {
    const PlainFitc plain(toy, inducing, output);
    const Eigen::MatrixXd scaled = plain.k_mn * plain.lambda.inverse().matrix().asDiagonal();
    const Eigen::MatrixXd b = plain.k_mm + scaled * plain.k_mn.transpose();
    const Eigen::VectorXd beta = b.inverse() * scaled * toy.targets.col(output);
    const Eigen::MatrixXd inverse = plain.k_mm.inverse() - b.inverse();
    EXPECT_LT((fit.model.beta.col(output) - beta).cwiseAbs().maxCoeff(),
              1e-8 * beta.cwiseAbs().maxCoeff());
    EXPECT_LT((fit.model.inverse[output] - inverse).cwiseAbs().maxCoeff(),
              1e-8 * inverse.cwiseAbs().maxCoeff());
    EXPECT_EQ(fit.model.inverse[output], fit.model.inverse[output].transpose());
  }
}

TEST(TrainSparseGp, ImprovesOnTheRandomSubset) {
  const SparseToy toy(60);
  const Eigen::MatrixXd start = toy.inputs.leftCols(8);
  const GpFit fit = trainSparseGp(start, toy.inputs, toy.targets, toy.hyperparameters, 50);
  ASSERT_TRUE(fit.ok()) << fit.message;
  ASSERT_EQ(1u, fit.outputs.size());
  EXPECT_EQ(sparseNegativeLogLikelihood(start, toy.inputs, toy.targets, toy.hyperparameters),
            fit.outputs[0].initial_cost);
  EXPECT_LT(fit.outputs[0].cost, fit.outputs[0].initial_cost - 1.0);
  EXPECT_EQ(fit.outputs[0].cost, sparseNegativeLogLikelihood(fit.model.inputs, toy.inputs,
                                                             toy.targets, toy.hyperparameters));
}

TEST(LearnGp, UsesInducingInputsOnlyBeyondTheSetSize) {
  const SparseToy toy(40);
  PilcoOptions options;
  options.max_points = 10;
  options.first_inducing_iterations = 20;
  GpLearnerState state;
  std::mt19937_64 rng(1);
  const auto learn = [&](int n) {
    return learnGp(options, toy.inputs.leftCols(n), toy.targets.topRows(n), &rng, &state);
  };
  const GpFit full = learn(10);
  ASSERT_TRUE(full.ok()) << full.message;
  EXPECT_EQ(toy.inputs.leftCols(10), full.model.inputs);
  EXPECT_EQ(2u, full.outputs.size());
  EXPECT_EQ(full.outputs[1].cost, learn(10).outputs[1].initial_cost) << "goes on from its optimum";

  const GpFit first = learn(30);
  ASSERT_TRUE(first.ok()) << first.message;
  EXPECT_EQ(10, first.model.numPoints());
  ASSERT_EQ(3u, first.outputs.size());

  const std::mt19937_64 before = rng;
  const GpFit next = learn(40);
  ASSERT_TRUE(next.ok()) << next.message;
  EXPECT_EQ(before, rng) << "the inducing inputs of the trial before are the start";
  EXPECT_EQ(next.outputs[2].initial_cost,
            sparseNegativeLogLikelihood(first.model.inputs, toy.inputs, toy.targets,
                                        next.model.hyperparameters));
}

TEST(LearnGp, LearnsHyperparametersFromSomePointsAndPredictsWithAll) {
  const SparseToy toy(60);
  PilcoOptions options;
  options.hyperparameter_points = 40;
  options.first_inducing_iterations = 5;
  const auto learn = [&](int max_points) {
    options.max_points = max_points;
    GpLearnerState state;
    std::mt19937_64 rng(1);
    return learnGp(options, toy.inputs, toy.targets, &rng, &state);
  };
  const GpFit full = learn(100);
  ASSERT_TRUE(full.ok()) << full.message;
  EXPECT_EQ(60, full.model.numPoints());
  const GpFit from_all = trainGp(toy.inputs, toy.targets, 300);
  const Eigen::MatrixXd difference =
      (full.model.hyperparameters - from_all.model.hyperparameters).topRows(2);
  EXPECT_GT(difference.cwiseAbs().maxCoeff(), 1e-6);  // they are trained on different points
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1.0);   // of the same function
  const GpFit few = learn(30);
  ASSERT_TRUE(few.ok()) << few.message;
  EXPECT_EQ(30, few.model.numPoints());
  EXPECT_EQ(full.model.hyperparameters, few.model.hyperparameters);
}

}  // namespace
}  // namespace ddm::pilco
