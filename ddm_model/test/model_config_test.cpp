// Tests of the configuration: the parameter reference has the defaults.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/model_config.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/parameter_reference.h"

namespace ddm {
namespace {

using testing::throwsNaming;

TEST(ModelReference, HasTheKeysAndDefaultsOfEachBlock) {
  testing::expectDefaults<ImageOptions>(DDM_MODEL_MANUAL, "image");
  testing::expectDefaults<ModelOptions>(DDM_MODEL_MANUAL, "model");
  testing::expectDefaults<TrainingOptions>(DDM_MODEL_MANUAL, "training");
  testing::expectDefaults<BagOptions>(DDM_MODEL_MANUAL, "data_set");
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

TEST(ModelConfig, RefusesEachValueOutOfRangeWithItsKeyRuleAndValue) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> rows = {
      {"image: {size: 0}", {"image/size", "[4, 1024]", "got 0"}},
      {"model: {ordre: 3}", {"model/ordre"}},
      {"model: {pca_dim: 0}", {"model/pca_dim", "got 0"}},
      {"model: {feature_dim: 101}", {"model/feature_dim", "got 101"}},
      {"model: {order: 0}", {"model/order", "[1, 50]", "got 0"}},
      {"model: {encoder_widths: [4097, 4]}", {"model/encoder_widths", "got 4097"}},
      {"model: {predictor_widths: [4, 0]}", {"model/predictor_widths", "got 0"}},
      {"model: {predictor: gpr}", {"model/predictor", "network or gp", "got gpr"}},
      {"model: {max_torque: [6, .inf]}", {"model/max_torque", "got [6, inf]"}},
      {"model: {max_torque: []}", {"model/max_torque", "got []"}},
      {"training: {schedule: jont}", {"training/schedule", "joint, ", "got jont"}},
      {"training: {solver: adam}", {"training/solver", "lbfgs, kfac or bfgs", "got adam"}},
      {"training: {max_iterations: 0}", {"training/max_iterations", "got 0"}},
      {"training: {function_tolerance: .nan}", {"training/function_tolerance", "got nan"}},
      {"training: {prediction_steps: 0}", {"training/prediction_steps", "got 0"}},
      {"training: {weight_decay: -0.5}", {"training/weight_decay", "got -0.5"}},
      {"data_set: {image_topic: camera/}", {"data_set/image_topic", "got 'camera/'"}},
      {"data_set: {goal_topic: /}", {"data_set/goal_topic", "got '/'"}},
      {"data_set: {goal_topic: /torque}", {"data_set/torque_topic", "goal_topic"}}};
  for (const auto& [yaml, parts] : rows) {
    ParamReader reader(YAML::Load(yaml));
    readModelConfig(&reader);
    EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { reader.requireValid(); }, parts)) << yaml;
  }
}

}  // namespace
}  // namespace ddm
