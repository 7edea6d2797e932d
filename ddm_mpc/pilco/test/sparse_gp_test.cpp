// Tests of the sparse GP (FITC) and of the learner that switches to it.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/sparse_gp.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "ddm_model/testing/gradient_check.h"
#include "ddm_model/testing/random_matrix.h"
#include "ddm_model/testing/vector_of.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/not_finite.h"
#include "ddm_pilco/gp_model.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::gradientMatches;
using ::ddm::testing::names;
using ::ddm::testing::randomMatrix;
using ::ddm::testing::throwsNaming;
using ::ddm::testing::vectorOf;

constexpr double kRidge = 1e-6;

struct SparseToy {
  explicit SparseToy(int n) : inputs(randomMatrix(2, n, 1)), targets(n, 2) {
    const Eigen::ArrayXd x = inputs.row(0), y = inputs.row(1);
    targets.col(0) = (1.5 * x).sin() + 0.5 * y;
    targets.col(1) = (x + y).cos();
    targets += 0.05 * randomMatrix(n, 2, 2);
    hyperparameters.log_length_scales.resize(2, 2);
    hyperparameters.log_length_scales << 0.1, 0.3, 0.8, 0.2;
    hyperparameters.log_signal_std = vectorOf({0.3, 0.1});
    hyperparameters.log_noise_std = vectorOf({-2.0, -1.5});
  }
  Eigen::MatrixXd inputs;
  Eigen::MatrixXd targets;
  Hyperparameters hyperparameters;
};

/// Matrices of one output as the formulas have them, inverted outright.
struct PlainFitc {
  PlainFitc(const SparseToy& toy, const Eigen::MatrixXd& inducing, int output) {
    const Eigen::VectorXd theta = thetaOf(toy.hyperparameters, output);
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
  EXPECT_NEAR(
      expected,
      sparseNegativeLogLikelihood(inducing, toy.inputs, toy.targets, toy.hyperparameters, kRidge),
      1e-8);
}

TEST(SparseLikelihood, IsThatOfTheFullGpWhereAllInputsAreInducing) {
  const SparseToy toy(12);
  double full = 0.0;
  for (int output = 0; output < 2; ++output) {
    full += negativeLogLikelihood(toy.inputs, toy.targets.col(output),
                                  thetaOf(toy.hyperparameters, output));
  }
  EXPECT_NEAR(
      full,
      sparseNegativeLogLikelihood(toy.inputs, toy.inputs, toy.targets, toy.hyperparameters, 1e-10),
      1e-5);
}

TEST(SparseLikelihood, GradientInTheInducingInputsMatchesDifferences) {
  const SparseToy toy(15);
  const Eigen::MatrixXd inducing = randomMatrix(2, 5, 3);
  const auto f = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Eigen::MatrixXd z = Eigen::Map<const Eigen::MatrixXd>(x.data(), 2, 5);
    Eigen::MatrixXd d_z;
    const double value =
        sparseNegativeLogLikelihood(z, toy.inputs, toy.targets, toy.hyperparameters, kRidge,
                                    gradient != nullptr ? &d_z : nullptr);
    if (gradient != nullptr) *gradient = Eigen::Map<const Eigen::VectorXd>(d_z.data(), 10);
    return value;
  };
  EXPECT_TRUE(gradientMatches(f, Eigen::Map<const Eigen::VectorXd>(inducing.data(), 10), 1e-7));
}

TEST(SparseLikelihood, IsInfiniteWherePositiveDefinitenessIsLost) {
  const SparseToy toy(10);
  const Eigen::MatrixXd same = Eigen::MatrixXd::Ones(2, 4);
  Eigen::MatrixXd gradient;
  EXPECT_EQ(std::numeric_limits<double>::infinity(),
            sparseNegativeLogLikelihood(same, toy.inputs, toy.targets, toy.hyperparameters, 0.0,
                                        &gradient));
  EXPECT_EQ(4, gradient.cols());
  EXPECT_FALSE(gradient.allFinite());
  EXPECT_TRUE(std::isfinite(
      sparseNegativeLogLikelihood(same, toy.inputs, toy.targets, toy.hyperparameters, kRidge)))
      << "the ridge makes repeated inducing inputs harmless";
}

TEST(SparseGpModel, HasTheMatricesOfTheFormulas) {
  const SparseToy toy(14);
  const Eigen::MatrixXd inducing = randomMatrix(2, 5, 3);
  const GpFit fit =
      makeSparseGpModel(inducing, toy.inputs, toy.targets, toy.hyperparameters, kRidge);
  ASSERT_TRUE(fit.ok) << fit.message;
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

TEST(SparseGpModel, NamesTheOutputThatIsNotPositiveDefinite) {
  SparseToy toy(14);
  toy.hyperparameters.log_signal_std[1] = 400.0;  // its square is beyond double
  const GpFit fit =
      makeSparseGpModel(toy.inputs, toy.inputs, toy.targets, toy.hyperparameters, kRidge);
  EXPECT_FALSE(fit.ok);
  EXPECT_NE(std::string::npos, fit.message.find("output 2")) << fit.message;
  EXPECT_EQ(0, fit.model.numPoints());
}

TEST(RandomSubset, DrawsDifferentPointsTheSameForTheSameSeed) {
  Eigen::MatrixXd inputs(1, 20);
  for (int i = 0; i < 20; ++i) inputs(0, i) = i;
  std::mt19937_64 rng(1), same(1), other(2);
  const Eigen::MatrixXd drawn = randomSubset(inputs, 8, &rng);
  EXPECT_EQ(8u, std::set<double>(drawn.data(), drawn.data() + 8).size());
  EXPECT_GE(drawn.minCoeff(), 0.0);
  EXPECT_LE(drawn.maxCoeff(), 19.0);
  EXPECT_EQ(drawn, randomSubset(inputs, 8, &same));
  EXPECT_NE(drawn, randomSubset(inputs, 8, &other));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { randomSubset(inputs, 21, &rng); },
                                                  {"cannot draw 21 of 20"}));
}

TEST(TrainSparseGp, ImprovesOnTheRandomSubset) {
  const SparseToy toy(60);
  std::mt19937_64 rng(1);
  const Eigen::MatrixXd start = randomSubset(toy.inputs, 8, &rng);
  const GpFit fit = trainSparseGp(start, toy.inputs, toy.targets, toy.hyperparameters, 50, kRidge);
  ASSERT_TRUE(fit.ok) << fit.message;
  ASSERT_EQ(1u, fit.outputs.size());
  EXPECT_EQ(
      sparseNegativeLogLikelihood(start, toy.inputs, toy.targets, toy.hyperparameters, kRidge),
      fit.outputs[0].initial_cost);
  EXPECT_LT(fit.outputs[0].cost, fit.outputs[0].initial_cost - 1.0);
  EXPECT_EQ(fit.outputs[0].cost,
            sparseNegativeLogLikelihood(fit.model.inputs, toy.inputs, toy.targets,
                                        toy.hyperparameters, kRidge));
}

TEST(TrainSparseGp, TellsWhereTheStartCannotBeEvaluated) {
  SparseToy toy(20);
  toy.hyperparameters.log_signal_std[0] = 400.0;
  const GpFit fit = trainSparseGp(toy.inputs.leftCols(5), toy.inputs, toy.targets,
                                  toy.hyperparameters, 50, kRidge);
  EXPECT_FALSE(fit.ok);
  EXPECT_NE(std::string::npos, fit.message.find("output 1")) << fit.message;
}

TEST(TrainSparseGp, RefusesInducingInputsThatDoNotFit) {
  const SparseToy toy(20);
  const auto training = [&](const Eigen::MatrixXd& start) {
    return [&toy, start] {
      trainSparseGp(start, toy.inputs, toy.targets, toy.hyperparameters, 5, kRidge);
    };
  };
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(training(Eigen::MatrixXd::Zero(3, 4)),
                                                  {"2 entries, got 4 of 3"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(training(Eigen::MatrixXd::Constant(2, 4, kNaN)),
                                                  {"finite"}));
}

TEST(GpLearner, CopesWithRepeatedPointsInBothGps) {
  const SparseToy toy(20);
  SparseGpOptions sparse;
  sparse.first_iterations = 20;
  for (const int max_points : {100, 30}) {  // full GP; sparse, with repeated inducing inputs
    sparse.max_points = max_points;
    GpLearner learner(GpTrainingOptions(), sparse);
    std::mt19937_64 rng(1);
    const GpFit fit = learner.learn(toy.inputs.replicate(1, 2), toy.targets.replicate(2, 1), &rng);
    ASSERT_TRUE(fit.ok) << fit.message;
    EXPECT_EQ(std::min(max_points, 40), fit.model.numPoints());
    EXPECT_TRUE(fit.model.beta.allFinite());
    EXPECT_TRUE(fit.model.inverse[0].allFinite() && fit.model.inverse[1].allFinite());
  }
}

TEST(GpLearner, RefusesNaNInTheDataAndStaysUsable) {
  const SparseToy toy(30);
  Eigen::MatrixXd inputs = toy.inputs, targets = toy.targets;
  inputs(1, 4) = kNaN;
  targets(28, 0) = kNaN;
  GpLearner learner(GpTrainingOptions{}, SparseGpOptions{});
  std::mt19937_64 rng(1);
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { learner.learn(inputs, toy.targets, &rng); },
                                                  {"input 2", "point 5 of 30", "nan"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { learner.learn(toy.inputs, targets, &rng); },
                                                  {"target 1", "point 29 of 30", "nan"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] {
        makeSparseGpModel(toy.inputs.leftCols(5), inputs, toy.targets, toy.hyperparameters, kRidge);
      },
      {"input 2", "point 5 of 30", "nan"}));
  EXPECT_TRUE(learner.learn(toy.inputs, toy.targets, &rng).ok);
}

TEST(GpLearner, UsesInducingInputsOnlyBeyondTheSetSize) {
  const SparseToy toy(40);
  SparseGpOptions sparse;
  sparse.max_points = 10;
  sparse.first_iterations = 20;
  sparse.max_iterations = 5;
  GpLearner learner(GpTrainingOptions(), sparse);
  std::mt19937_64 rng(1);
  const GpFit full = learner.learn(toy.inputs.leftCols(10), toy.targets.topRows(10), &rng);
  ASSERT_TRUE(full.ok) << full.message;
  EXPECT_EQ(toy.inputs.leftCols(10), full.model.inputs);
  EXPECT_EQ(2u, full.outputs.size());

  const GpFit first = learner.learn(toy.inputs.leftCols(30), toy.targets.topRows(30), &rng);
  ASSERT_TRUE(first.ok) << first.message;
  EXPECT_EQ(10, first.model.numPoints());
  ASSERT_EQ(3u, first.outputs.size());
  EXPECT_GT(first.outputs[2].iterations, 5);

  const std::mt19937_64 before = rng;
  const GpFit next = learner.learn(toy.inputs, toy.targets, &rng);
  ASSERT_TRUE(next.ok) << next.message;
  EXPECT_LE(next.outputs[2].iterations, 5);
  EXPECT_EQ(before, rng) << "the inducing inputs of the trial before are the start";
  EXPECT_EQ(next.outputs[2].initial_cost,
            sparseNegativeLogLikelihood(first.model.inputs, toy.inputs, toy.targets,
                                        next.model.hyperparameters, sparse.ridge));
}

TEST(GpLearner, StartsFromItsLastOptimum) {
  const SparseToy toy(30);
  GpLearner learner(GpTrainingOptions{}, SparseGpOptions{});
  std::mt19937_64 rng(1);
  const GpFit first = learner.learn(toy.inputs, toy.targets, &rng);
  const GpFit again = learner.learn(toy.inputs, toy.targets, &rng);
  ASSERT_TRUE(first.ok && again.ok) << first.message << again.message;
  for (int output = 0; output < 2; ++output) {
    EXPECT_LT(first.outputs[output].cost, first.outputs[output].initial_cost);
    EXPECT_EQ(first.outputs[output].cost, again.outputs[output].initial_cost);
  }
}

void expectSameModel(const GpModel& expected, const GpModel& got) {
  EXPECT_EQ(expected.inputs, got.inputs);
  EXPECT_EQ(expected.beta, got.beta);
  EXPECT_EQ(expected.inverse, got.inverse);
  EXPECT_EQ(expected.hyperparameters.log_length_scales, got.hyperparameters.log_length_scales);
  EXPECT_EQ(expected.hyperparameters.log_signal_std, got.hyperparameters.log_signal_std);
  EXPECT_EQ(expected.hyperparameters.log_noise_std, got.hyperparameters.log_noise_std);
}

TEST(GpLearner, AnotherGoesOnFromItsStateToTheSameBytes) {
  const SparseToy toy(40);
  SparseGpOptions sparse;
  sparse.first_iterations = 20;
  sparse.max_iterations = 5;
  for (const int max_points : {100, 10}) {  // full GP, sparse GP
    sparse.max_points = max_points;
    GpLearner a(GpTrainingOptions(), sparse);
    EXPECT_EQ(0, a.state().hyperparameters.log_signal_std.size());
    EXPECT_EQ(0, a.state().inducing.size());
    std::mt19937_64 rng(1);
    const GpFit first = a.learn(toy.inputs.leftCols(30), toy.targets.topRows(30), &rng);
    ASSERT_TRUE(first.ok) << first.message;
    const GpLearnerState saved = a.state();
    ASSERT_EQ(2, saved.hyperparameters.log_noise_std.size());
    EXPECT_EQ(first.model.hyperparameters.log_noise_std, saved.hyperparameters.log_noise_std);
    EXPECT_EQ(max_points == 10 ? 20 : 0, saved.inducing.size());

    const GpFit expected = a.learn(toy.inputs, toy.targets, &rng);
    GpLearner b(GpTrainingOptions(), sparse, saved);
    const GpFit got = b.learn(toy.inputs, toy.targets, &rng);
    ASSERT_TRUE(expected.ok && got.ok) << expected.message << got.message;
    expectSameModel(expected.model, got.model);
    EXPECT_EQ(a.state().inducing, b.state().inducing);

    GpLearner anew(GpTrainingOptions(), sparse);
    EXPECT_NE(expected.model.beta, anew.learn(toy.inputs, toy.targets, &rng).model.beta);
  }
}

TEST(GpLearner, RefusesAStateOfOtherInputsAndKeepsItAsItWas) {
  const SparseToy toy(30);
  SparseGpOptions sparse;
  sparse.max_points = 10;
  GpLearnerState state;
  state.inducing = Eigen::MatrixXd::Zero(3, 10);
  GpLearner learner(GpTrainingOptions(), sparse, state);
  std::mt19937_64 rng(1);
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { learner.learn(toy.inputs, toy.targets, &rng); }, {"2 entries, got 10 of 3"}));
  EXPECT_EQ(0, learner.state().hyperparameters.log_signal_std.size());
}

TEST(GpLearner, LearnsHyperparametersFromSomePointsAndPredictsWithAll) {
  const SparseToy toy(60);
  GpTrainingOptions training;
  training.training_points = 40;
  SparseGpOptions sparse;
  sparse.first_iterations = 5;
  const auto learn = [&](int max_points) {
    sparse.max_points = max_points;
    GpLearner learner(training, sparse);
    std::mt19937_64 rng(1);
    return learner.learn(toy.inputs, toy.targets, &rng);
  };
  const GpFit full = learn(100);
  ASSERT_TRUE(full.ok) << full.message;
  EXPECT_EQ(60, full.model.numPoints());
  const GpFit from_all = trainGp(toy.inputs, toy.targets, GpTrainingOptions());
  const Eigen::MatrixXd difference = full.model.hyperparameters.log_length_scales -
                                     from_all.model.hyperparameters.log_length_scales;
  EXPECT_GT(difference.cwiseAbs().maxCoeff(), 1e-6);  // other points
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1.0);   // of the same function
  const GpFit few = learn(30);
  ASSERT_TRUE(few.ok) << few.message;
  EXPECT_EQ(30, few.model.numPoints());
  EXPECT_EQ(full.model.hyperparameters.log_length_scales,
            few.model.hyperparameters.log_length_scales);
}

TEST(GpLearner, CallsBackAfterEachEvaluationOfAnObjective) {
  const SparseToy toy(20);
  SparseGpOptions sparse;
  sparse.max_points = 10;
  sparse.first_iterations = 5;
  GpLearner learner(GpTrainingOptions(), sparse);
  std::mt19937_64 rng(1);
  int calls = 0;
  const GpFit fit = learner.learn(toy.inputs, toy.targets, &rng, [&calls] { ++calls; });
  ASSERT_EQ(3u, fit.outputs.size()) << fit.message;
  int evaluations = 0;
  for (const Minimum& output : fit.outputs) {
    EXPECT_GT(output.evaluations, 1);
    evaluations += output.evaluations;
  }
  EXPECT_EQ(evaluations, calls);
}

TEST(SparseGpOptions, AllProblemsAreReportedAndNaNIsOne) {
  EXPECT_TRUE(SparseGpOptions().problems().empty());
  SparseGpOptions options;
  options.max_points = 0;
  options.first_iterations = -1;
  options.max_iterations = -1;
  options.ridge = kNaN;
  ASSERT_EQ(4u, options.problems().size());
  EXPECT_TRUE(names(options.problems()[0], {"sparse_gp/max_points", ">= 1", "got 0"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { GpLearner(GpTrainingOptions(), options); },
                                                  {"sparse_gp/max_points"}));
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
