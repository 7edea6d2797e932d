// Tests of starting from bags and models: they must fit together, or are refused.
// SPDX-License-Identifier: BSD-3-Clause
#include "start.h"

#include <ddm_bag_io/bag_writer.h>
#include <ddm_common/image_codec.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>

#include <memory>

#include "toy_run.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using testing::toyConfiguration;

class StartTest : public ::testing::Test {
 protected:
  /// Writes a bag with three samples at intervals of 0.2 s.
  std::string bag(int image_size) {
    const std::string path = scratch_.file(std::to_string(image_size) + ".bag");
    BagWriter writer(path, BagOptions());
    for (int frame = 0; frame < 3; ++frame) {
      const ros::Time stamp(1.0 + 0.2 * frame);
      const std::vector<std::uint8_t> grey(image_size * image_size, 10 * frame);
      ddm_msgs::Torque torque;
      torque.header.stamp = stamp;
      torque.torque = {0.5};
      writer.write(encodeImage(grey, image_size, stamp, "camera"));
      writer.write(torque);
    }
    writer.close();
    return path;
  }

  /// A model that fits the configuration but was never trained.
  std::shared_ptr<const Ddm> untrainedModel(int torque_dim) const {
    const ModelOptions& options = configuration_.model.model;
    const int image_size = configuration_.model.image.size;
    Pca pca;
    pca.mean = Eigen::VectorXf::Zero(image_size * image_size);
    pca.basis = Eigen::MatrixXf::Identity(image_size * image_size, options.pca_dim);
    pca.variance = Eigen::VectorXd::Ones(options.pca_dim);
    const Eigen::VectorXd theta =
        Eigen::VectorXd::Zero(Networks<double>(options, torque_dim).numParams());
    return std::make_shared<const Ddm>(options, image_size, torque_dim, pca, theta, Image(),
                                       ModelInfo());
  }

  testing::TempFolder scratch_;
  Configuration configuration_ = toyConfiguration(scratch_.file("run"));
};

TEST_F(StartTest, BagsOfThePlantGetTheirChecksums) {
  configuration_.start.bags = {bag(51)};
  prepareStart(&configuration_);
  ASSERT_EQ(configuration_.start.checksums.size(), 1U);
  EXPECT_EQ(configuration_.start.checksums[0].substr(0, 6), "crc32-");
  EXPECT_NO_THROW(prepareStart(&configuration_));  // a resumed experiment
  configuration_.start.checksums[0] = "crc32-00000000";
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([this] { prepareStart(&configuration_); },
                                                  {"51.bag has changed", "crc32-00000000"}));
}

TEST_F(StartTest, WhereARobotActsBagsMustFitItAndNotThePlant) {
  configuration_.robot = RobotOptions();
  configuration_.model.image.size = 20;
  configuration_.start.bags = {bag(20)};
  EXPECT_NO_THROW(prepareStart(&configuration_));
  configuration_.robot->dt = 0.4;
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([this] { prepareStart(&configuration_); },
                                                  {"20.bag", "robot", "(dt): 0.2 ", ", 0.4 "}));
  configuration_.robot->dt = 0.2;
  configuration_.start = StartOptions();
  configuration_.start.bags = {bag(51)};
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([this] { prepareStart(&configuration_); },
                                                  {"51.bag", ": 51x51 mono8 ", ", 20x20 mono8 "}));
}

TEST_F(StartTest, WhereARobotActsAModelMustHaveItsMotorsAndNotThoseOfThePlant) {
  configuration_.robot = RobotOptions();
  configuration_.robot->max_torque = {6.0, 6.0};
  EXPECT_NO_THROW(requireModelFits(untrainedModel(2), "two.ddm", configuration_));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [this] { requireModelFits(untrainedModel(1), "one.ddm", configuration_); },
      {"one.ddm", "torques of 1", "robot 2", "robot/max_torque"}));
}

}  // namespace
}  // namespace ddm
