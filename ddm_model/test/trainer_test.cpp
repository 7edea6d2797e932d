// Tests of the training: it learns, it repeats itself, it can be stopped, it refuses.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ddm_model/ddm.h"
#include "ddm_model/minimise.h"
#include "ddm_model/objective.h"
#include "toy_data.h"

namespace ddm {
namespace {

class Trainer : public ::testing::Test {
 protected:
  Trainer() {
    silenceSolverLog();
    data_.append(testing::toyTrial(30, 2));
    data_.setGoal(testing::toyImage(3.0));
    training_.max_iterations = 30;
    info_.seed = 5;
    info_.trial = 1;
    info_.config = "model: {}\n";
  }

  TrainingResult run(const TrainingCallback& callback = nullptr) const {
    return train(data_, model_, training_, info_, callback);
  }

  static double errorOf(const TrainingResult& result) {
    return result.model->info().v_r + result.model->info().v_p;
  }

  DataSet data_ = testing::toyTrial(30, 1);
  ModelOptions model_ = testing::toyModelOptions();
  TrainingOptions training_;
  ModelInfo info_;
};

TEST_F(Trainer, LowersTheCostWithEachSolver) {
  for (const char* solver : {"lbfgs", "kfac", "bfgs"}) {
    training_.solver = solver;
    double initial = 0.0;  // as long as only the principal components are computed
    const TrainingResult result = run([&initial](const TrainingProgress& progress) {
      if (initial == 0.0) initial = progress.v_r + progress.v_p;
      return true;
    });
    ASSERT_TRUE(result.model) << solver << ": " << result.message;
    EXPECT_LT(errorOf(result), 0.5 * initial) << solver;
    EXPECT_GE(result.evaluations, result.iterations) << solver;
    EXPECT_GT(result.seconds, 0.0) << solver;
  }
}

TEST_F(Trainer, ReportsTheErrorsOfTheModelItReturns) {
  const Ddm model = run().model.value();
  TrainingData<double> data;
  data.scores = model.pca().project(data_).cast<double>();
  ASSERT_EQ(data.scores.cols(), 61);  // the goal is the last
  data.torques = data_.torques();
  data.segments = data_.segments();
  const Networks<double> nets(model_, 1);
  const auto value = JointObjective<double>(nets, data).evaluate(model.theta(), nullptr);
  const double grey_per_score = 1.0 / model.pca().scale;
  EXPECT_NEAR(model.info().v_r / (value.v_r * grey_per_score * grey_per_score), 1.0, 1e-3);
  EXPECT_NEAR(model.info().v_p / (value.v_p * grey_per_score * grey_per_score), 1.0, 1e-3);
}

TEST_F(Trainer, LowersWhatItsScheduleMinimises) {
  training_.max_iterations = 100;
  const ModelInfo joint = run().model->info();
  training_.schedule = "v_p_only";
  const ModelInfo v_p_only = run().model->info();
  training_.schedule = "sequential";
  const ModelInfo sequential = run().model->info();
  EXPECT_LT(v_p_only.v_p, joint.v_p);
  EXPECT_GT(v_p_only.v_r, 10.0 * joint.v_r);
  EXPECT_GT(v_p_only.v_r, 10.0 * sequential.v_r);
  EXPECT_GT(sequential.v_p, joint.v_p);
  training_.schedule = "v_r_only";
  EXPECT_EQ(run().model->info().v_r, sequential.v_r);
}

TEST_F(Trainer, KeepsTheBestOfSeveralStarts) {
  const TrainingResult first = run();
  training_.num_starts = 5;
  const TrainingResult several = run();
  ASSERT_TRUE(several.model);
  EXPECT_LT(errorOf(several), errorOf(first));  // with these data the first is not the best
  EXPECT_GT(several.evaluations, 4 * first.evaluations);
}

TEST_F(Trainer, TheBestRestartContinuesAloneOnAllSamples) {
  data_.append(testing::toyTrial(560, 3));  // parts of 200, 400 and all 620 samples
  training_.num_starts = 5;
  training_.function_tolerance = 0.0;
  training_.max_iterations = 40;
  double last = 0.0;
  const TrainingResult result = run([&](const TrainingProgress& progress) {
    EXPECT_GE(progress.fraction_done, last);
    last = progress.fraction_done;
    return true;
  });
  ASSERT_TRUE(result.model) << result.message;
  EXPECT_EQ(result.iterations, 5 * 80 + 40);
  EXPECT_DOUBLE_EQ(last, 1.0);
  EXPECT_EQ(result.model->info().frames, 620U);
}

TEST_F(Trainer, SkipsAPartThatHardlyDiffersFromAllSamples) {
  data_.append(testing::toyTrial(400, 3));  // parts of 200 and all 460 samples, without one of 400
  training_.num_starts = 2;
  training_.function_tolerance = 0.0;
  training_.max_iterations = 40;
  EXPECT_EQ(run().iterations, 2 * 40 + 40);
}

TEST_F(Trainer, AGaussianProcessPredictsTheFeaturesOfTheBetterHalfOfTheRestarts) {
  data_.append(testing::toyTrial(260, 3));  // parts of 200 and all 320 samples
  model_.predictor = "gp";
  training_.num_starts = 4;
  training_.function_tolerance = 0.0;
  training_.max_iterations = 40;
  double done = 0.0;
  const TrainingResult result = run([&](const TrainingProgress& progress) {
    done = progress.fraction_done;
    return true;
  });
  ASSERT_TRUE(result.model) << result.message;
  EXPECT_EQ(result.iterations, 4 * 40 + 2 * 40);
  EXPECT_DOUBLE_EQ(done, 1.0);
  EXPECT_EQ(result.model->featureDim(), 2 * model_.feature_dim);
  const Eigen::MatrixXd Z = encodeAll(*result.model, data_);
  EXPECT_FALSE(Z.topRows(model_.feature_dim).isApprox(Z.bottomRows(model_.feature_dim), 0.1));
}

TEST_F(Trainer, KnowsTheSpreadOfItsFeatures) {
  const Ddm model = run().model.value();
  const Eigen::MatrixXd Z = encodeAll(model, data_);
  const double spread =
      std::sqrt((Z.colwise() - Z.rowwise().mean()).squaredNorm() / static_cast<double>(Z.cols()));
  EXPECT_NEAR(model.info().feature_spread, spread, 0.1 * spread);  // the goal counts there, too
}

TEST_F(Trainer, TellsOneProgressOverAllStartsAndStopsThemAll) {
  training_.num_starts = 3;
  double last = -1.0;
  int calls = 0;
  const TrainingResult result = run([&](const TrainingProgress& progress) {
    EXPECT_GE(progress.fraction_done, last);
    last = progress.fraction_done;
    return ++calls < 50;  // in the second start
  });
  EXPECT_GT(last, 1.0 / 3.0);
  EXPECT_EQ(calls, 50);
  EXPECT_TRUE(result.cancelled);
  EXPECT_FALSE(result.model);
}

TEST_F(Trainer, AGaussianProcessPredictsBetter) {
  data_.append(testing::toyTrial(200, 3));
  const TrainingResult network = run();
  model_.predictor = "gp";
  const TrainingResult gp = run();
  ASSERT_TRUE(network.model && gp.model) << network.message << gp.message;
  const DataSet test = testing::toyTrial(40, 7);
  const auto error = [&](const Ddm& model) {  // of all rollouts over three steps
    const Eigen::MatrixXd Z = encodeAll(model, test);
    double squares = 0.0;
    for (Eigen::Index t = 1; t + 3 < test.numFrames(); ++t) {
      squares += (model.rollOut(Z, test.torques(), t, 3) - Z.middleCols(t, 4)).squaredNorm();
    }
    return std::sqrt(squares) / model.info().feature_spread;
  };
  EXPECT_LT(error(*gp.model), 0.9 * error(*network.model));
  EXPECT_EQ(run().model->theta(), gp.model->theta());
}

TEST_F(Trainer, AnotherSeedOrTrialGivesAnotherModel) {
  const Eigen::VectorXd theta = run().model->theta();
  info_.seed = 5 + (1ULL << 32);  // the high bits count, too
  EXPECT_NE(run().model->theta(), theta);
  info_.seed = 5;
  info_.trial = 2;
  EXPECT_NE(run().model->theta(), theta);
}

TEST_F(Trainer, TellsItsProgress) {
  training_.max_iterations = 1000;
  training_.function_tolerance = 0.0;  // line searches get difficult
  std::vector<TrainingProgress> told;
  const TrainingResult result = run([&told](const TrainingProgress& progress) {
    if (progress.v_r > 0.0) told.push_back(progress);  // before, there are no parameters
    return true;
  });
  ASSERT_GE(told.size(), 10U);
  const auto cost = [](const auto& at) { return at.v_r + at.v_p; };
  for (size_t i = 1; i < told.size(); ++i) {
    EXPECT_EQ(told[i].iteration, told[i - 1].iteration + 1);
    EXPECT_LE(cost(told[i]), cost(told[i - 1])) << "not the accepted point, but one probed later";
  }
  EXPECT_NEAR(cost(result.model->info()) / cost(told.back()), 1.0, 1e-6);
  EXPECT_GT(told.back().gradient_norm, 0.0);
}

TEST_F(Trainer, ReportsAndStopsTheFitOfAGaussianProcessToo) {
  model_.predictor = "gp";
  const int iterations = run().iterations;
  std::vector<TrainingProgress> told;
  run([&told](const TrainingProgress& progress) {
    if (progress.v_r > 0.0) told.push_back(progress);  // before, there are no parameters
    return true;
  });
  ASSERT_GT(told.back().fraction_done, 0.99);
  for (size_t i = 1; i < told.size(); ++i) {
    EXPECT_GE(told[i].fraction_done, told[i - 1].fraction_done);
    EXPECT_GE(told[i].iteration, told[i - 1].iteration);
  }
  EXPECT_EQ(told.back().iteration, iterations);
  bool was_last = false;
  int last_iteration = 0;
  const TrainingResult stopped = run([&](const TrainingProgress& progress) {
    // The second report of the last iteration comes from the fit.
    was_last = progress.iteration == iterations && last_iteration == iterations;
    last_iteration = progress.iteration;
    return !was_last;
  });
  EXPECT_TRUE(was_last && stopped.cancelled && !stopped.model);
}

TEST_F(Trainer, StopsBeforeItsPrincipalComponentsAreThere) {
  const TrainingResult result = run([](const TrainingProgress&) { return false; });
  EXPECT_TRUE(result.cancelled);
  EXPECT_FALSE(result.model);
  EXPECT_EQ(result.evaluations, 0);
}

TEST_F(Trainer, AnAutoEncoderAloneNeedsNothingToPredict) {
  DataSet segments(testing::kToySize, 1);
  for (unsigned seed = 1; seed <= 20; ++seed) segments.append(testing::toyTrial(2, seed));
  data_ = segments;
  training_.schedule = "v_r_only";
  const TrainingResult result = run();
  EXPECT_TRUE(result.model) << result.message;
}

}  // namespace
}  // namespace ddm
