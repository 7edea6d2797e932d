// Tests of the model file: every byte comes back, and no damage goes unseen.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/model_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "ddm_msgs/testing/expect_error.h"
#include "toy_data.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using testing::toyModel;

// Layout: magic (8 bytes), version (4), size of the content (8), CRC-32 of the content (4).
constexpr size_t kVersionAt = 8;
constexpr size_t kChecksumAt = 20;
constexpr size_t kContentAt = 24;

::testing::AssertionResult isRefused(const std::string& bytes,
                                     const std::vector<std::string>& parts = {}) {
  std::vector<std::string> all = {"trial_007.model"};
  all.insert(all.end(), parts.begin(), parts.end());
  return throwsNaming<std::runtime_error>([&] { deserialiseModel(bytes, "trial_007.model"); }, all);
}

/// The bytes with a checksum that fits whatever their content is now.
std::string sealed(std::string bytes) {
  const auto crc =
      static_cast<std::uint32_t>(std::stoul(checksum(bytes.substr(kContentAt)), nullptr, 16));
  std::memcpy(&bytes[kChecksumAt], &crc, sizeof(crc));
  return bytes;
}

TEST(ModelFile, ComesBackBitForBit) {
  for (bool with_goal : {true, false}) {
    const Ddm model = toyModel(with_goal);
    const std::string bytes = serialiseModel(model);
    const Ddm back = deserialiseModel(bytes, "memory");
    EXPECT_EQ(serialiseModel(back), bytes);
    EXPECT_EQ(back.goal(), model.goal());
    EXPECT_EQ(back.info().seed, model.info().seed);
    EXPECT_EQ(back.info().v_p, model.info().v_p);
    EXPECT_EQ(back.info().config, model.info().config);
    EXPECT_EQ(back.encode(testing::toyImage(0.5)), model.encode(testing::toyImage(0.5)));
  }
}

TEST(ModelFile, KeepsEveryOptionALimitForEachMotorAndSupportStates) {
  const Ddm one = toyModel();
  ModelOptions options = one.options();
  options.max_torque = {4.0, 2.0};
  options.normalise_brightness = true;
  options.blur = 1.5;
  options.order = 3;
  ModelInfo info = one.info();
  info.support_states = testing::randomMatrix(3 * 2 + 2 * 2, 9, 5).cast<float>();
  Pca pca = one.pca();
  pca.brightness = 0.2F;
  pca.blur = Blur(one.imageSize(), options.blur);
  const Eigen::Index num_params = Networks<double>(options, 2).numParams();
  const Ddm model(options, one.imageSize(), 2, pca, testing::randomMatrix(num_params, 1, 4),
                  one.goal(), info);
  const std::string bytes = serialiseModel(model);
  const Ddm back = deserialiseModel(bytes, "memory");
  EXPECT_EQ(back.options().max_torque, options.max_torque);
  EXPECT_EQ(back.predictionModel().maxTorque(), Eigen::Vector2d(4.0, 2.0));
  EXPECT_TRUE(back.options().normalise_brightness);
  EXPECT_EQ(back.options().blur, options.blur);
  EXPECT_EQ(back.options().order, 3);
  EXPECT_EQ(back.info().support_states, info.support_states);
  EXPECT_EQ(back.encode(testing::toyImage(0.5)), model.encode(testing::toyImage(0.5)));
  EXPECT_EQ(serialiseModel(back), bytes);
}

TEST(ModelFile, KeepsAGaussianProcessAndRefusesAPartOfACentre) {
  const Ddm one = toyModel();
  ModelOptions options = one.options();
  options.predictor = "gp";
  const Eigen::Index num_params = Networks<double>(options, 1, /*num_centres=*/3).numParams();
  const auto with = [&](Eigen::Index count) {
    return Ddm(options, one.imageSize(), 1, one.pca(), testing::randomMatrix(count, 1, 4),
               one.goal(), one.info());
  };
  const Ddm model = with(num_params);
  const Ddm back = deserialiseModel(serialiseModel(model), "memory");
  const Eigen::MatrixXd Z = testing::randomMatrix(2, 8, 1), U = testing::randomMatrix(1, 8, 2);
  EXPECT_EQ(back.rollOut(Z, U, 3, 4), model.rollOut(Z, U, 3, 4));
  EXPECT_THROW(with(num_params - 1), std::invalid_argument);
  EXPECT_THROW(with(one.theta().size() / 8), std::invalid_argument);
}

TEST(ModelFile, CutShortAnywhereIsRefused) {
  const std::string bytes = serialiseModel(toyModel());
  for (size_t size = 0; size < bytes.size(); size += 7) {
    ASSERT_TRUE(isRefused(bytes.substr(0, size))) << size << " of " << bytes.size() << " bytes";
  }
  EXPECT_TRUE(isRefused(bytes.substr(0, bytes.size() - 1), {"cut short"}));
}

TEST(ModelFile, AnyByteThatIsDamagedIsNoticed) {
  const std::string bytes = serialiseModel(toyModel());
  for (size_t at = 0; at < bytes.size(); ++at) {
    for (char flip : {char(0x01), char(0x80), char(0xff)}) {
      std::string damaged = bytes;
      damaged[at] ^= flip;
      ASSERT_TRUE(isRefused(damaged)) << "byte " << at;
    }
  }
}

TEST(ModelFile, AnotherVersionIsRefusedWithBothVersionsAndTheRemedy) {
  std::string bytes = serialiseModel(toyModel());
  for (const char version : {8, 10}) {
    bytes[kVersionAt] = version;
    EXPECT_TRUE(
        isRefused(bytes, {"version " + std::to_string(version), "reads version 9", "train it"}));
  }
}

TEST(ModelFile, WhatIsNoModelIsRefused) {
  EXPECT_TRUE(isRefused("", {"DDMMODEL"}));
  EXPECT_TRUE(isRefused("# a text file, and longer than the header of a model\n", {"DDMMODEL"}));
  EXPECT_TRUE(isRefused("DDMMODEL", {"cut short"}));
}

TEST(ModelFile, ContentThatMakesNoSenseIsRefusedThoughItsChecksumFits) {
  const std::string bytes = serialiseModel(toyModel());
  const auto withNumber = [&bytes](size_t at, std::int32_t value) {
    std::string changed = bytes;
    std::memcpy(&changed[kContentAt + at], &value, sizeof(value));
    return sealed(changed);
  };
  EXPECT_EQ(withNumber(0, 6), bytes);  // pca_dim comes first: nothing has changed
  EXPECT_TRUE(isRefused(withNumber(0, 7), {"no sense", "PCA"}));
  EXPECT_TRUE(isRefused(withNumber(0, -1), {"no sense", "model/pca_dim"}));
  EXPECT_TRUE(isRefused(withNumber(8, 0), {"no sense", "model/order"}));
  EXPECT_TRUE(isRefused(withNumber(12, 0x7fffffff), {"no sense", "longer"}));
  EXPECT_EQ(withNumber(87, testing::kToySize), bytes);  // the image size follows the options
  EXPECT_TRUE(isRefused(withNumber(87, 0), {"no sense", "image size", "[1, 16384]", "got 0"}));
  EXPECT_TRUE(isRefused(withNumber(91, 1001), {"no sense", "motors", "[1, 1000]", "got 1001"}));
}

TEST(ModelFile, SupportStatesThatAreNoStatesAreRefused) {
  const Ddm model = toyModel();
  ModelInfo info = model.info();
  const auto bytes = [&] {
    return serialiseModel(
        Ddm(model.options(), model.imageSize(), 1, model.pca(), model.theta(), model.goal(), info));
  };
  info.support_states = Eigen::MatrixXf::Ones(3, 1);
  EXPECT_TRUE(isRefused(bytes(), {"no sense", "support states"}));
  info.support_states = Eigen::MatrixXf::Constant(5, 1, std::numeric_limits<float>::infinity());
  EXPECT_TRUE(isRefused(bytes(), {"no sense", "support states"}));
}

}  // namespace
}  // namespace ddm
