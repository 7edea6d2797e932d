// Tests of a model on the wire.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/model_message.h"

#include <gtest/gtest.h>

#include "ddm_model/model_file.h"
#include "toy_data.h"

namespace ddm {
namespace {

TEST(ModelMessage, HoldsTheWholeModelAndSaysWhatItIs) {
  const Ddm model = testing::toyModel();
  const ddm_msgs::Model message = toMessage(model, ros::Time(12.5));
  const std::string bytes(message.data.begin(), message.data.end());
  EXPECT_EQ(bytes, serialiseModel(model));
  EXPECT_EQ(message.id, modelId(bytes));
  EXPECT_EQ(message.header.stamp, ros::Time(12.5));
  EXPECT_EQ(message.trial, 7U);
  EXPECT_EQ(message.frames, 800U);
  EXPECT_EQ(message.seed, model.info().seed);
  EXPECT_EQ(message.image_size, 8U);
  EXPECT_EQ(message.feature_dim, 2U);
  EXPECT_EQ(message.torque_dim, 1U);
  EXPECT_EQ(message.order, 2U);
  EXPECT_EQ(message.v_r, model.info().v_r);
  EXPECT_EQ(message.v_p, model.info().v_p);
  EXPECT_EQ(message.config_hash, checksum(model.info().config));
}

}  // namespace
}  // namespace ddm
