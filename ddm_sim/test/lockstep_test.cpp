// Tests of sim_node in lock-step through its topics and services.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>

#include "ddm_msgs/testing/not_finite.h"
#include "ddm_sim/pendulum.h"
#include "sim_client.h"

namespace ddm {
namespace {

class Lockstep : public SimNodeTest {
 protected:
  /// Begins an episode and waits for its first image.
  /// @return the stamp of the first image
  static ros::Time begin(std::uint32_t num_steps, const std::vector<double>& start = {0.0, 0.0}) {
    client_->forget();
    const ddm_msgs::Reset::Response response = client_->reset(num_steps, start);
    EXPECT_TRUE(response.success) << response.message;
    EXPECT_TRUE(client_->waitForImages(1));
    return response.start;
  }

  /// Expects that the episode has ended: a torque for its last image gives no new image, and the
  /// next image is the first of the next episode.
  static void expectIdle(const ros::Time& stamp_on_show) {
    const std::size_t shown = client_->images.size();
    client_->publish(stamp_on_show, {0.0});
    const ddm_msgs::Reset::Response response = client_->reset(0, {0.0, 0.0});
    ASSERT_TRUE(client_->waitForImages(shown + 1));
    EXPECT_EQ(client_->images[shown].header.stamp, response.start);
  }
};

// Must be the first test of this file: no reset may come before it.
TEST_F(Lockstep, ShowsClockAndGoalButNoImageBeforeTheFirstReset) {
  ASSERT_TRUE(client_->waitUntil([] { return !client_->clocks.empty(); }));
  ASSERT_TRUE(client_->waitUntil([] { return !client_->goals.empty(); }));
  EXPECT_EQ(client_->clocks[0], ros::Time(1, 0));
  const Pendulum plant{PendulumOptions()};
  EXPECT_EQ(client_->goals[0].data, plant.render(plant.goal()).bytes);
  EXPECT_EQ(client_->goals[0].encoding, "mono8");
  const ddm_msgs::Reset::Response response = client_->reset(0);
  EXPECT_EQ(response.goal, client_->goals.back().header.stamp);
  EXPECT_TRUE(client_->waitForImages(1));
  ASSERT_EQ(client_->images.size(), 1U);
  EXPECT_EQ(client_->images[0].header.stamp, response.start);
}

TEST_F(Lockstep, ShowsExactlyTheImagesAskedForEachDtAfterTheLast) {
  const ros::Time start = begin(5);
  for (std::size_t t = 0; t < 5; ++t) {
    ASSERT_TRUE(client_->waitForImages(t + 1));
    const ros::Time stamp = client_->images[t].header.stamp;
    EXPECT_EQ(stamp.toNSec(), start.toNSec() + t * 200000000ULL);
    client_->publish(stamp, {1.0});
  }
  ASSERT_TRUE(client_->waitForLog("5 frames answered"));
  EXPECT_EQ(client_->images.size(), 5U);
  expectIdle(client_->images[4].header.stamp);
}

TEST_F(Lockstep, MovesThePlantAsTheLibraryDoesAndPublishesWhatActedAndTheTruthOfEachImage) {
  Pendulum plant{PendulumOptions()};
  plant.setState(Eigen::Vector2d(0.3, -1.7));
  begin(4, {0.3, -1.7});
  const std::vector<double> torques{2.0, -9.0, 0.5};  // the second torque saturates
  double applied = 0.0;
  for (std::size_t t = 0; t < 4; ++t) {
    ASSERT_TRUE(client_->waitForImages(t + 1));
    const sensor_msgs::JointState& truth = client_->truths[t];
    const sensor_msgs::Image& image = client_->images[t];
    EXPECT_EQ(truth.header.stamp, image.header.stamp);
    EXPECT_EQ(truth.name, std::vector<std::string>{"pendulum"});
    EXPECT_EQ(truth.position, std::vector<double>{plant.state()[0]});
    EXPECT_EQ(truth.velocity, std::vector<double>{plant.state()[1]});
    EXPECT_EQ(truth.effort, std::vector<double>{applied});
    EXPECT_EQ(image.data, plant.render(plant.state()).bytes);
    if (t == 3) break;
    client_->publish(image.header.stamp, {torques[t]});
    applied = plant.step(Eigen::VectorXd::Constant(1, torques[t]))[0];
    ASSERT_TRUE(client_->waitUntil([t] { return client_->applied.size() == t + 1; }));
    EXPECT_EQ(client_->applied[t].header.stamp, image.header.stamp);
    EXPECT_EQ(client_->applied[t].torque, std::vector<double>{applied});
  }
}

TEST_F(Lockstep, CountsAndIgnoresATorqueWithAnotherStamp) {
  const ros::Time start = begin(0);
  client_->publish(start + ros::Duration(0, 1), {6.0});
  ASSERT_TRUE(client_->waitForLog("ignored, waiting for frame 0"));
  EXPECT_EQ(client_->images.size(), 1U);
  client_->publish(start, {1.0});
  ASSERT_TRUE(client_->waitForImages(2));
  EXPECT_EQ(client_->truths[1].effort, std::vector<double>{1.0});
  client_->publish(start, {6.0});  // an old stamp, which is ignored
  client_->publish(client_->images[1].header.stamp, {2.0});
  ASSERT_TRUE(client_->waitForImages(3));
  EXPECT_EQ(client_->truths[2].effort, std::vector<double>{2.0});
}

TEST_F(Lockstep, GoesOnAfterABadTorqueWithAnotherStamp) {
  const ros::Time start = begin(0);
  client_->publish(start + ros::Duration(7.0), {kNaN});
  ASSERT_TRUE(client_->waitForLog("torque refused"));
  client_->publish(start, {1.0});
  EXPECT_TRUE(client_->waitForImages(2));
}

TEST_F(Lockstep, RefusesATorqueThatNoMotorHasNamesItsPublisherAndEndsTheTrial) {
  const double far_beyond = -1001.0 * PendulumOptions().max_torque.front();
  const std::vector<std::pair<std::vector<double>, std::string>> cases{{{kNaN}, "nan]"},
                                                                       {{-kInfinity}, "[-inf]"},
                                                                       {{}, "1 finite"},
                                                                       {{1.0, 2.0}, "[1 2]"},
                                                                       {{far_beyond}, "6000"}};
  for (const auto& [torque, text] : cases) {
    const ros::Time start = begin(0);
    client_->publish(start, torque);
    ASSERT_TRUE(client_->waitForLog("torque refused: " + ros::this_node::getName()));
    EXPECT_TRUE(client_->logged(text)) << text;
    ASSERT_TRUE(client_->waitForLog("trial 0 ends"));
    expectIdle(start);
  }
}

TEST_F(Lockstep, NamesThePublisherThatKeepsSilentAndGoesIdle) {
  const ros::Time start = begin(0);
  client_->publish(start, {1.0});
  ASSERT_TRUE(client_->waitForImages(2));
  ASSERT_TRUE(client_->waitForLog("1.5 s"));
  EXPECT_TRUE(client_->logged("frame 1"));
  EXPECT_TRUE(client_->logged("/torque: " + ros::this_node::getName()));
  expectIdle(client_->images[1].header.stamp);
}

TEST_F(Lockstep, StartsEachTrialAtLeastASecondLaterAndNeverTurnsTheClockBack) {
  ros::Time last;
  for (int trial = 0; trial < 3; ++trial) {
    const ros::Time start = begin(0);
    if (trial > 0) {
      EXPECT_GE(start - last, ros::Duration(1.0));
    }
    client_->publish(start, {1.0});
    ASSERT_TRUE(client_->waitForImages(2));
    last = client_->images[1].header.stamp;
    ASSERT_TRUE(client_->waitUntil([last] { return client_->clocks.back() == last; }));
  }
  for (std::size_t i = 1; i < client_->clocks.size(); ++i) {
    ASSERT_GE(client_->clocks[i], client_->clocks[i - 1]);
  }
}

TEST_F(Lockstep, CutsARunningTrialShortOnReset) {
  const ros::Time old_start = begin(0);
  const ros::Time start = begin(0, {1.0, 0.0});
  EXPECT_TRUE(client_->waitForLog("cut short"));
  client_->publish(old_start, {1.0});
  client_->publish(start, {0.0});
  ASSERT_TRUE(client_->waitForImages(2));
  EXPECT_EQ(client_->truths[0].position, std::vector<double>{1.0});
  EXPECT_EQ(client_->truths[1].effort, std::vector<double>{0.0});
}

TEST_F(Lockstep, RefusesABadStartAndLeavesTheTrialAlone) {
  const ros::Time start = begin(0, {0.5, 0.0});
  for (const std::vector<double>& bad :
       {std::vector<double>{1.0}, std::vector<double>{1.0, kNaN}}) {
    const ddm_msgs::Reset::Response response = client_->reset(0, bad);
    EXPECT_FALSE(response.success);
    EXPECT_NE(response.message.find("2 finite number(s)"), std::string::npos) << response.message;
  }
  client_->publish(start, {0.0});
  ASSERT_TRUE(client_->waitForImages(2));
  EXPECT_EQ(client_->truths.size(), 2U);
}

TEST_F(Lockstep, EndsATrialWhoseStateLeavesTheRangeOfDouble) {
  const ros::Time start = begin(0, {1.7e308, 1.7e308});
  client_->publish(start, {0.0});
  ASSERT_TRUE(client_->waitForLog("1.7e+308"));
  expectIdle(start);
}

}  // namespace
}  // namespace ddm
