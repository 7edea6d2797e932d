// Tests of the training schedules: what each minimises over what.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/schedule.h"

#include <gtest/gtest.h>

namespace ddm {
namespace {

TEST(Schedule, JointRandomInitIsJointWithoutThePcaStart) {
  TrainingOptions training;
  EXPECT_TRUE(makeSchedule(training).pca_start);
  training.schedule = "joint_random_init";
  const Schedule schedule = makeSchedule(training);
  EXPECT_FALSE(schedule.pca_start);
  ASSERT_EQ(schedule.stages.size(), 1U);
  EXPECT_TRUE(schedule.stages[0].terms.v_r && schedule.stages[0].terms.v_p);
  EXPECT_EQ(schedule.stages[0].free, Stage::Free::kAll);
}

TEST(Schedule, EachStageHasTheOptionsOfTheTraining) {
  TrainingOptions training;
  training.schedule = "sequential";
  training.max_iterations = 900;
  training.prediction_steps = 5;
  training.weight_decay = 2.0;
  const Schedule schedule = makeSchedule(training);
  ASSERT_EQ(schedule.stages.size(), 2U);
  EXPECT_EQ(schedule.stages[0].terms.prediction_steps, 1);  // the auto-encoder predicts nothing
  EXPECT_EQ(schedule.stages[1].terms.prediction_steps, 5);
  for (const Stage& stage : schedule.stages) {
    EXPECT_EQ(stage.terms.weight_decay, 2.0);
    EXPECT_EQ(stage.max_iterations, 900);
  }
  const Terms all = schedule.terms();
  EXPECT_TRUE(all.v_r && all.v_p && all.prediction_steps == 5 && all.weight_decay == 2.0);
}

}  // namespace
}  // namespace ddm
