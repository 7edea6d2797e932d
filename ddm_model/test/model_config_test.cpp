// Tests of the configuration: the parameter reference has the defaults.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/model_config.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/parameter_reference.h"
#include "trial_recorder.h"

namespace ddm {
namespace {

using testing::throwsNaming;

TEST(ModelReference, HasTheKeysAndDefaultsOfEachBlock) {
  testing::expectDefaults<ImageOptions>(DDM_MODEL_MANUAL, "image");
  testing::expectDefaults<ModelOptions>(DDM_MODEL_MANUAL, "model");
  testing::expectDefaults<TrainingOptions>(DDM_MODEL_MANUAL, "training");
  testing::expectDefaults<BagOptions>(DDM_MODEL_MANUAL, "data_set");
  testing::expectDefaults<RecorderOptions>(DDM_MODEL_MANUAL, "recorder");
}

TEST(ModelConfig, ItsTextReadsBackAsTheSameConfiguration) {
  ModelConfig config;
  config.image.size = 33;
  config.model.encoder_widths = {};
  config.model.max_torque = {0.1 + 0.2};
  config.training.solver = "bfgs";
  config.data_set.goal_topic = "/aim";
  ParamReader reader(YAML::Load(toText(config)));
  EXPECT_EQ(toText(readModelConfig(&reader)), toText(config));
  EXPECT_NO_THROW(reader.requireValid());
}

TEST(ModelConfig, ReportsTheProblemsOfAllBlocksAtOnce) {
  ParamReader reader(YAML::Load(
      "{image: {size: 0}, model: {ordre: 3}, training: {solver: 7}, data_set: {goal_topic: ''}}"));
  readModelConfig(&reader);
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { reader.requireValid(); },
      {"image/size", "model/ordre", "training/solver", "data_set/goal_topic"}));
}

TEST(BagOptions, RefusesTopicsWithoutAName) {
  EXPECT_TRUE(BagOptions().problems().empty());
  for (std::string BagOptions::*topic :
       {&BagOptions::image_topic, &BagOptions::torque_topic, &BagOptions::goal_topic}) {
    for (const char* bad : {"", "/", "camera/"}) {
      BagOptions options;
      options.*topic = bad;
      ASSERT_EQ(options.problems().size(), 1U) << bad;
      EXPECT_NE(options.problems().front().find("got '" + std::string(bad) + "'"),
                std::string::npos);
    }
  }
}

TEST(RecorderOptions, RefusesATimeoutThatIsNone) {
  EXPECT_TRUE(RecorderOptions().problems().empty());
  for (double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                     std::numeric_limits<double>::infinity(), 1e5}) {
    RecorderOptions options;
    options.timeout = bad;
    ASSERT_EQ(options.problems().size(), 1U) << bad;
    EXPECT_TRUE(testing::names(options.problems().front(), {"recorder/timeout", "(0, 86400]"}));
  }
}

}  // namespace
}  // namespace ddm
