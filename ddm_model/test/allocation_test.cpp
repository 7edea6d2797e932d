// The objective takes its memory once: an evaluation asks the heap for nothing.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <new>
#include <vector>

#include "ddm_model/objective.h"
#include "ddm_model/testing/allocation_counter.h"
#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace {

using testing::allocationsOf;

class Allocation : public ::testing::TestWithParam<const char*> {};

TEST_P(Allocation, AnEvaluationTakesNoMemory) {
  ModelOptions options;
  options.predictor = GetParam();
  const Networks<float> networks(options, 1);
  TrainingData<float> data;
  data.scores = testing::randomMatrix(options.pca_dim, 301, 1).cast<float>();
  data.torques = testing::randomMatrix(1, 300, 2);
  data.segments = {{0, 200}, {200, 100}};
  JointObjective<float> objective(networks, data);
  const Eigen::VectorXf theta =
      0.1F * testing::randomMatrix(networks.numParams(), 1, 3).cast<float>();
  Eigen::VectorXf d_theta;
  Terms terms;
  for (const int steps : {1, 4}) {
    terms.prediction_steps = steps;
    terms.weight_decay = 0.1;
    objective.evaluate(theta, &d_theta, terms);  // takes it
    EXPECT_EQ(allocationsOf([&] { objective.evaluate(theta, &d_theta, terms); }), 0) << steps;
    EXPECT_EQ(allocationsOf([&] { objective.evaluate(theta, nullptr, terms); }), 0) << steps;
  }
}

TEST(ObjectiveMemory, LackOfMemoryInAThreadIsAnExceptionOfTheEvaluation) {
  const Networks<float> networks(ModelOptions(), 1);
  TrainingData<float> data;
  data.scores = testing::randomMatrix(ModelOptions().pca_dim, 600, 1).cast<float>();
  data.torques = testing::randomMatrix(1, 600, 2);
  data.segments = {{0, 600}};
  const Eigen::VectorXf theta =
      0.1F * testing::randomMatrix(networks.numParams(), 1, 3).cast<float>();
  long needed = 0;
  for (int i = 0; i < 2; ++i) {  // the first one also makes the threads
    JointObjective<float> objective(networks, data);
    needed = allocationsOf([&] { objective.evaluate(theta, nullptr); });
  }
  JointObjective<float> objective(networks, data);
  testing::refused_allocation = testing::allocations + needed - 1;  // of the lanes
  EXPECT_THROW(objective.evaluate(theta, nullptr), std::bad_alloc);
  testing::refused_allocation = -1;
}

INSTANTIATE_TEST_SUITE_P(BothPredictors, Allocation, ::testing::Values("network", "gp"));

}  // namespace
}  // namespace ddm
