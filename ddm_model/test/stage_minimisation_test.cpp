// Tests of one stage of training: K-FAC's factors and coordinates, and numbers that overflow.
// SPDX-License-Identifier: BSD-3-Clause
#include "stage_minimisation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "ddm_model/minimise.h"
#include "ddm_model/objective.h"
#include "ddm_model/testing/random_matrix.h"
#include "ddm_model/trainer.h"
#include "toy_data.h"

namespace ddm {
namespace {

using testing::randomMatrix;

TEST(Preconditioner, LeavesALayerAloneWhoseErrorsNobodyCounts) {
  KroneckerFactors<float> factors(4, 3);
  factors.add(Eigen::MatrixXf::Zero(4, 20), Eigen::MatrixXf::Zero(3, 20));
  const Eigen::VectorXf v = randomMatrix(15, 1, 3).cast<float>();
  EXPECT_TRUE(Preconditioner({factors})(v).allFinite());
}

class FactorsOfTheObjective : public ::testing::Test {
 protected:
  FactorsOfTheObjective() {
    options_.pca_dim = 4;
    options_.encoder_widths = {3};
    options_.predictor_widths = {3};
    data_.scores = randomMatrix(4, 151, 1);  // the last one is the goal's
    data_.torques = randomMatrix(1, 150, 2);
    data_.segments = {{0, 100}, {100, 50}};
  }

  LayerFactors<double> factors(const Terms& terms) {
    const Networks<double> networks(options_, 1);
    JointObjective<double> objective(networks, data_);
    weight_ = objective.weight();
    std::mt19937_64 rng(1);
    return objective.factors(randomMatrix(networks.numParams(), 1, 3), terms, &rng);
  }

  ModelOptions options_;
  TrainingData<double> data_;
  double weight_ = 0.0;
};

TEST_F(FactorsOfTheObjective, AreThoseOfEveryLayerInTurn) {
  const LayerFactors<double> all = factors(Terms());
  ASSERT_EQ(all.size(), 6U);  // two layers of each network
  const auto twice =
      data_.scores.middleCols(74, 2);  // of the first part, and for predictions in the second
  EXPECT_TRUE(all[0].inputs.topLeftCorner(4, 4).isApprox(
      data_.scores * data_.scores.transpose() + twice * twice.transpose(), 1e-12));
  EXPECT_EQ(all[0].num_samples, 151 + 2);
  EXPECT_EQ(all[2].num_samples, 151 + 98 + 48);  // images, and targets with two predecessors
  EXPECT_EQ(all[4].num_samples, 98 + 48);
}

TEST_F(FactorsOfTheObjective, CountEachScoreAsTheObjectiveDoes) {
  for (int steps : {1, 2}) {
    Terms terms;
    terms.prediction_steps = steps;
    const LayerFactors<double> all = factors(terms);
    // Each of the k predictions counts 1/k. The last target of a segment has only the first of them.
    const double count = 151.0 + (steps == 1 ? 146.0 : (146.0 + 144.0) / 2.0);
    for (Eigen::Index i = 0; i < 4; ++i) {
      EXPECT_NEAR(all[3].errors(i, i), weight_ * count, 1e-9 * weight_ * count) << steps;
    }
  }
}

TEST_F(FactorsOfTheObjective, LeaveOutWhatIsNotMinimised) {
  const LayerFactors<double> all = factors(Terms{true, false});
  EXPECT_NEAR(all[3].errors(0, 0), weight_ * 151.0, 1e-9);
  EXPECT_EQ(all[4].errors.norm(), 0.0);  // f only predicts
}

TEST(Kfac, FallsFasterThanLbfgsAndCountsItsIterations) {
  const DataSet data = testing::toyTrial(60, 1);
  TrainingOptions training;
  training.max_iterations = 120;  // the factors are computed anew twice
  training.function_tolerance = 0.0;
  const TrainingResult plain = train(data, testing::toyModelOptions(), training, ModelInfo());
  training.solver = "kfac";
  std::vector<int> seen;
  const TrainingResult kfac = train(data, testing::toyModelOptions(), training, ModelInfo(),
                                    [&seen](const TrainingProgress& progress) {
                                      seen.push_back(progress.iteration);
                                      return true;
                                    });
  ASSERT_TRUE(plain.model && kfac.model) << plain.message << ", " << kfac.message;
  const ModelInfo &by_kfac = kfac.model->info(), &by_lbfgs = plain.model->info();
  EXPECT_LT(by_kfac.v_r + by_kfac.v_p, 0.7 * (by_lbfgs.v_r + by_lbfgs.v_p));
  EXPECT_EQ(kfac.iterations, 120);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 120);
}

class StageMinimisation : public ::testing::Test {
 protected:
  StageMinimisation() {
    silenceSolverLog();
    stage_.max_iterations = 1;
  }

  TrainingData<float> someData() const {
    TrainingData<float> data;
    data.scores = randomMatrix(options_.pca_dim, 150, 1).cast<float>();
    data.torques = randomMatrix(1, 150, 2);
    data.segments = {{0, 150}};
    return data;
  }

  /// Sets the weights of the decoder's last layer.
  void setLastWeights(double weight) {
    shapes_.decoder().weights(shapes_.decoderOf(theta_.data()), 1).setConstant(weight);
  }

  SolverResult run(const std::string& solver) {
    TrainingOptions training;
    training.solver = solver;
    return minimiseStage(stage_, training, networks_, &objective_, &theta_, nullptr);
  }

  const ModelOptions options_ = testing::toyModelOptions();
  const Networks<double> shapes_{options_, 1};
  const Networks<float> networks_{options_, 1};
  JointObjective<float> objective_{networks_, someData()};
  Stage stage_;
  Eigen::VectorXd theta_ = randomMatrix(shapes_.numParams(), 1, 3);
};

TEST_F(StageMinimisation, KeepsParametersFiniteWhereAKroneckerFactorOverflows) {
  // Hidden units that are 0 hide the large weights from the objective, but not from back-propagated errors.
  setLastWeights(2e18);
  shapes_.decoder().weights(shapes_.decoderOf(theta_.data()), 0).setZero();
  shapes_.decoder().biases(shapes_.decoderOf(theta_.data()), 0).setZero();
  std::mt19937_64 rng(1);
  const LayerFactors<float> factors = objective_.factors(theta_.cast<float>(), stage_.terms, &rng);
  ASSERT_FALSE(factors[2].errors.allFinite()) << "the test shows nothing";
  const SolverResult result = run("kfac");
  EXPECT_TRUE(std::isfinite(result.cost)) << result.message;
  EXPECT_TRUE(theta_.allFinite());
}

TEST_F(StageMinimisation, LeavesParametersAsTheyAreWhereTheObjectiveCannotBeEvaluated) {
  setLastWeights(1e30);
  const Eigen::VectorXd before = theta_;
  for (const char* solver : {"lbfgs", "kfac", "bfgs"}) {
    EXPECT_EQ(run(solver).reason, TerminationReason::kStartFailed) << solver;
    EXPECT_EQ(theta_, before) << solver;
  }
}

}  // namespace
}  // namespace ddm
