// Tests of the marginal likelihood and of training on it.
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

/// A smooth function of three inputs, the last of which does not matter, with noise of std 0.05.
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
  Eigen::MatrixXd inputs = Eigen::MatrixXd::Zero(3, 4);  // four times the same point
  Eigen::VectorXd theta = someTheta();
  theta[4] = -30.0;  // and no noise to tell them apart
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
    if (gradient != nullptr) *gradient = x;  // that of the first term
    return 0.5 * x.squaredNorm() + penalty(x, input_std, gradient);
  };
  theta << std::log(190.0), std::log(9.0), 3.0, -3.8;  // near the limits
  EXPECT_TRUE(gradientMatches(f, theta, 1e-6));
}

TEST(TrainGp, EndsAtAnOptimumThatKnowsNoiseAndRelevance) {
  const Toy toy(80);
  const GpFit fit = trainGp(toy.inputs, toy.targets, kIterations);
  ASSERT_TRUE(fit.ok) << fit.message;
  EXPECT_EQ("", fit.message);
  ASSERT_EQ(2u, fit.outputs.size());
  for (int output = 0; output < 2; ++output) {
    EXPECT_LT(fit.outputs[output].cost, fit.outputs[output].initial_cost - 1.0);
    EXPECT_LT(fit.outputs[output].gradient.norm(), 1e-4);
    EXPECT_LE(fit.outputs[output].iterations, 300);
    EXPECT_GE(fit.outputs[output].evaluations, fit.outputs[output].iterations);
    EXPECT_NEAR(0.05, std::exp(fit.model.hyperparameters.log_noise_std[output]), 0.02);
    EXPECT_GT(fit.model.hyperparameters.log_length_scales(2, output), std::log(5.0));
  }
  const Eigen::VectorXd theta = thetaOf(fit.model.hyperparameters, 1);
  const double expected = negativeLogLikelihood(toy.inputs, toy.targets.col(1), theta) +
                          penalty(theta, sampleStd(toy.inputs));
  EXPECT_NEAR(expected, fit.outputs[1].cost, 1e-9 * std::abs(expected));
}

TEST(TrainGp, TrainsAnewAndSaysSoWhereThePreviousOptimumCannotBeEvaluated) {
  Toy toy(20);
  toy.inputs.col(3) = toy.inputs.col(5);
  Hyperparameters bad = initialHyperparameters(toy.inputs, toy.targets);
  bad.log_noise_std[1] = -40.0;
  const GpFit fit = trainGp(toy.inputs, toy.targets, kIterations, &bad);
  ASSERT_TRUE(fit.ok) << fit.message;
  EXPECT_TRUE(names(fit.message, {"output 2: ", "previous hyper-parameters"}));
}

TEST(TrainGp, TellsThatTheLikelihoodCannotBeEvaluatedAtAll) {
  Toy toy(20);
  toy.targets.col(1) *= 1e-161;  // its noise variance is below what double can tell from 0
  const GpFit fit = trainGp(toy.inputs, toy.targets, kIterations);
  EXPECT_FALSE(fit.ok);
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

}  // namespace
}  // namespace ddm::pilco
