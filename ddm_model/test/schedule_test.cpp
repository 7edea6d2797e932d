// Tests of the training schedules: what each minimises over what.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/schedule.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"

namespace ddm {
namespace {

TEST(Schedule, EachMinimisesItsTermsOverItsParameters) {
  using Free = Stage::Free;
  struct Row {
    std::string name;
    bool pca_start;
    std::vector<Stage> stages;
  };
  const Stage joint{{true, true}, Free::kAll}, auto_encoder{{true, false}, Free::kAutoEncoder};
  const Stage predictor{{false, true}, Free::kPredictor}, v_p{{false, true}, Free::kAll};
  const std::vector<Row> rows = {{"joint", true, {joint}},
                                 {"sequential", true, {auto_encoder, predictor}},
                                 {"v_p_only", true, {v_p}},
                                 {"v_r_only", true, {auto_encoder}},
                                 {"joint_random_init", false, {joint}}};
  ASSERT_EQ(scheduleNames().size(), rows.size());
  for (const Row& row : rows) {
    TrainingOptions training;
    training.schedule = row.name;
    const Schedule schedule = makeSchedule(training);
    EXPECT_EQ(schedule.pca_start, row.pca_start) << row.name;
    ASSERT_EQ(schedule.stages.size(), row.stages.size()) << row.name;
    for (size_t i = 0; i < row.stages.size(); ++i) {
      EXPECT_EQ(schedule.stages[i].terms.v_r, row.stages[i].terms.v_r) << row.name;
      EXPECT_EQ(schedule.stages[i].terms.v_p, row.stages[i].terms.v_p) << row.name;
      EXPECT_EQ(schedule.stages[i].free, row.stages[i].free) << row.name;
    }
  }
}

TEST(Schedule, PredictionsOfSeveralStepsAreWarmedUpByOne) {
  TrainingOptions training;
  training.schedule = "sequential";
  training.warm_up_iterations = 70;
  training.max_iterations = 900;
  training.prediction_steps = 5;
  training.weight_decay = 2.0;
  const Schedule schedule = makeSchedule(training);
  ASSERT_EQ(schedule.stages.size(), 3U);  // the auto-encoder predicts nothing
  EXPECT_EQ(schedule.stages[0].max_iterations, 900);
  EXPECT_EQ(schedule.stages[1].max_iterations, 70);
  EXPECT_EQ(schedule.stages[1].terms.prediction_steps, 1);
  EXPECT_EQ(schedule.stages[2].max_iterations, 900);
  EXPECT_EQ(schedule.stages[2].terms.prediction_steps, 5);
  for (const Stage& stage : schedule.stages) EXPECT_EQ(stage.terms.weight_decay, 2.0);
  const Terms all = schedule.terms();
  EXPECT_TRUE(all.v_r && all.v_p && all.prediction_steps == 5 && all.weight_decay == 2.0);
  training.warm_up_iterations = 0;
  EXPECT_EQ(makeSchedule(training).stages.size(), 2U);
}

TEST(Schedule, TheRestAfterTheChoiceIsForTheBestStartAlone) {
  TrainingOptions training;
  training.max_iterations = 900;
  EXPECT_FALSE(makeSchedule(training).finish);
  training.selection_iterations = 200;
  const Schedule schedule = makeSchedule(training);
  EXPECT_EQ(schedule.stages.back().max_iterations, 200);
  ASSERT_TRUE(schedule.finish);
  EXPECT_EQ(schedule.finish->max_iterations, 700);
  training.selection_iterations = 900;
  EXPECT_FALSE(makeSchedule(training).finish);
}

TEST(Schedule, RefusesAnUnknownName) {
  TrainingOptions training;
  training.schedule = "jont";
  EXPECT_TRUE(testing::throwsNaming<std::invalid_argument>([&] { makeSchedule(training); },
                                                           {"jont", "joint, sequential"}));
}

}  // namespace
}  // namespace ddm
