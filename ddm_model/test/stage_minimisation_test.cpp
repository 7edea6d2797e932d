// Tests of one stage of training: where numbers overflow, the parameters stay usable.
// SPDX-License-Identifier: BSD-3-Clause
#include "stage_minimisation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "ddm_model/solver_log.h"
#include "ddm_model/testing/random_matrix.h"
#include "toy_data.h"

namespace ddm {
namespace {

using testing::randomMatrix;

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

  Minimum run(const std::string& solver) {
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
  const Minimum minimum = run("kfac");
  EXPECT_TRUE(std::isfinite(minimum.cost)) << minimum.message;
  EXPECT_TRUE(theta_.allFinite());
}

TEST_F(StageMinimisation, LeavesParametersAsTheyAreWhereTheObjectiveCannotBeEvaluated) {
  setLastWeights(1e30);
  const Eigen::VectorXd before = theta_;
  for (const char* solver : {"lbfgs", "kfac", "bfgs"}) {
    EXPECT_EQ(run(solver).reason, MinimumReason::kStartFailed) << solver;
    EXPECT_EQ(theta_, before) << solver;
  }
}

}  // namespace
}  // namespace ddm
