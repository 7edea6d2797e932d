// Tests of the training schedules: what each minimises over what.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/schedule.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

TEST(Schedule, EveryNameHasOneWithAStage) {
  ASSERT_EQ(scheduleNames(), (std::vector<std::string>{"joint", "sequential", "v_p_only",
                                                       "v_r_only", "joint_random_init"}));
  for (const std::string& name : scheduleNames()) EXPECT_FALSE(makeSchedule(name).stages.empty());
}

TEST(Schedule, JointMinimisesBothTermsOverAllParametersFromPca) {
  const Schedule joint = makeSchedule("joint");
  EXPECT_TRUE(joint.pca_start);
  ASSERT_EQ(joint.stages.size(), 1u);
  EXPECT_TRUE(joint.stages[0].terms.v_r && joint.stages[0].terms.v_p);
  EXPECT_EQ(joint.stages[0].free, Stage::Free::kAll);
  EXPECT_FALSE(makeSchedule("joint_random_init").pca_start);
}

TEST(Schedule, SequentialLearnsTheAutoEncoderBeforeThePrediction) {
  const Schedule sequential = makeSchedule("sequential");
  ASSERT_EQ(sequential.stages.size(), 2u);
  EXPECT_TRUE(sequential.stages[0].terms.v_r && !sequential.stages[0].terms.v_p);
  EXPECT_EQ(sequential.stages[0].free, Stage::Free::kAutoEncoder);
  EXPECT_TRUE(!sequential.stages[1].terms.v_r && sequential.stages[1].terms.v_p);
  EXPECT_EQ(sequential.stages[1].free, Stage::Free::kPredictor);
}

TEST(Schedule, VpOnlyLeavesTheReconstructionOut) {
  const Schedule v_p_only = makeSchedule("v_p_only");
  ASSERT_EQ(v_p_only.stages.size(), 1u);
  EXPECT_TRUE(!v_p_only.stages[0].terms.v_r && v_p_only.stages[0].terms.v_p);
  EXPECT_EQ(v_p_only.stages[0].free, Stage::Free::kAll);
}

TEST(Schedule, VrOnlyLearnsTheAutoEncoderAlone) {
  const Schedule v_r_only = makeSchedule("v_r_only");
  EXPECT_TRUE(v_r_only.pca_start);
  ASSERT_EQ(v_r_only.stages.size(), 1u);
  EXPECT_TRUE(v_r_only.stages[0].terms.v_r && !v_r_only.stages[0].terms.v_p);
  EXPECT_EQ(v_r_only.stages[0].free, Stage::Free::kAutoEncoder);
}

TEST(Schedule, TellsTheTermsThatAnyStageMinimises) {
  EXPECT_TRUE(makeSchedule("sequential").terms().v_r && makeSchedule("sequential").terms().v_p);
  EXPECT_TRUE(!makeSchedule("v_p_only").terms().v_r && makeSchedule("v_p_only").terms().v_p);
}

TEST(Schedule, PredictionsOfSeveralStepsAreWarmedUpByOne) {
  TrainingOptions training;
  training.warm_up_iterations = 70;
  training.max_iterations = 900;
  EXPECT_EQ(makeSchedule(training).stages.size(), 1u);
  training.prediction_steps = 5;
  training.weight_decay = 2.0;
  const Schedule joint = makeSchedule(training);
  ASSERT_EQ(joint.stages.size(), 2u);
  EXPECT_EQ(joint.stages[0].max_iterations, 70);
  EXPECT_EQ(joint.stages[1].max_iterations, 900);
  EXPECT_EQ(joint.stages[0].terms.prediction_steps, 1);
  EXPECT_EQ(joint.stages[1].terms.prediction_steps, 5);
  EXPECT_EQ(joint.terms().prediction_steps, 5);
  for (const Stage& stage : joint.stages) EXPECT_EQ(stage.terms.weight_decay, 2.0);
  EXPECT_EQ(joint.terms().weight_decay, 2.0);
  training.schedule = "sequential";
  const Schedule sequential = makeSchedule(training);
  ASSERT_EQ(sequential.stages.size(), 3u);  // the auto-encoder predicts nothing
  EXPECT_EQ(sequential.stages[0].max_iterations, 900);
  EXPECT_EQ(sequential.stages[1].max_iterations, 70);
  training.warm_up_iterations = 0;
  EXPECT_EQ(makeSchedule(training).stages.size(), 2u);
}

TEST(Schedule, TheRestAfterTheChoiceIsForTheBestStartAlone) {
  TrainingOptions training;
  training.max_iterations = 900;
  training.prediction_steps = 5;
  EXPECT_FALSE(makeSchedule(training).finish);
  training.num_starts = 4;
  training.selection_iterations = 200;
  const Schedule schedule = makeSchedule(training);
  EXPECT_EQ(schedule.stages.back().max_iterations, 200);
  ASSERT_TRUE(schedule.finish);
  EXPECT_EQ(schedule.finish->max_iterations, 700);
  EXPECT_EQ(schedule.finish->terms.prediction_steps, 5);
  training.selection_iterations = 900;
  EXPECT_FALSE(makeSchedule(training).finish);
  EXPECT_EQ(makeSchedule(training).stages.back().max_iterations, 900);
}

TEST(Schedule, RefusesAnUnknownName) {
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>(
      [] { makeSchedule("jont"); },
      {"jont", "joint, sequential, v_p_only, v_r_only, joint_random_init"}));
}

}  // namespace
}  // namespace ddm
