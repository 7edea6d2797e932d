// Tests of sim_node in real time through its topics and services.
// SPDX-License-Identifier: BSD-3-Clause
#include <actionlib_msgs/GoalID.h>
#include <ddm_msgs/testing/node_main.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>
#include <limits>

#include "sim_client.h"

namespace ddm {
namespace {

class Realtime : public SimNodeTest {
 protected:
  void SetUp() override {
    client_->reset(0, {0.0, 0.0});
    client_->forget();
  }

  /// Waits for the next image whose ground truth contains this torque.
  static bool waitForEffort(double effort) {
    const std::size_t seen = client_->truths.size();
    return client_->waitUntil([seen, effort] {
      for (std::size_t i = seen; i < client_->truths.size(); ++i) {
        if (client_->truths[i].effort[0] == effort) return true;
      }
      return false;
    });
  }

  /// Waits for the next image; its ground truth may arrive before or after it.
  /// @return the stamp of the image
  static ros::Time nextImage() {
    const std::size_t seen = client_->images.size();
    EXPECT_TRUE(client_->waitUntil([seen] { return client_->images.size() > seen; }));
    return client_->images[seen].header.stamp;
  }

  /// Waits for the applied torque of an image.
  static std::vector<double> appliedAt(const ros::Time& stamp) {
    const ddm_msgs::Torque* found = nullptr;
    EXPECT_TRUE(client_->waitUntil([&] {
      for (const ddm_msgs::Torque& applied : client_->applied) {
        if (applied.header.stamp == stamp) found = &applied;
      }
      return found != nullptr;
    }));
    return found == nullptr ? std::vector<double>{kNothing} : found->torque;
  }
  static constexpr double kNothing = -77.0;

  static std::ptrdiff_t numFramesWithEffort(double effort) {
    return std::count_if(client_->truths.begin(), client_->truths.end(),
                         [effort](const auto& truth) { return truth.effort[0] == effort; });
  }
};

TEST_F(Realtime, ShowsImagesByItselfStampedWithWallTime) {
  const double before = ros::WallTime::now().toSec();
  ASSERT_TRUE(client_->waitForImages(4));
  const double after = ros::WallTime::now().toSec();
  for (std::size_t i = 0; i < 4; ++i) {
    const double stamp = client_->images[i].header.stamp.toSec();
    EXPECT_GT(stamp, before - 1.0);
    EXPECT_LT(stamp, after);
    EXPECT_TRUE(client_->waitUntil([i] {
      return std::any_of(client_->truths.begin(), client_->truths.end(), [i](const auto& truth) {
        return truth.header.stamp == client_->images[i].header.stamp;
      });
    }));
  }
  const double three_periods =
      (client_->images[3].header.stamp - client_->images[0].header.stamp).toSec();
  // Less than three periods, because a busy machine delays images; a burst of images fails.
  EXPECT_GT(three_periods, 2 * 0.1);
}

TEST_F(Realtime, HoldsATorqueForTwoPeriodsAndThenSwitchesTheMotorOff) {
  client_->publish(ros::Time(5, 0), {3.0});
  ASSERT_TRUE(waitForEffort(3.0));
  ASSERT_TRUE(waitForEffort(0.0));
  ASSERT_TRUE(waitForEffort(0.0));  // and it stays off
  EXPECT_EQ(numFramesWithEffort(3.0), 2);
}

TEST_F(Realtime, WhatIsPublishedAsAppliedIsWhatTheMotorHadUntilTheNextImage) {
  client_->forget();
  std::vector<ros::Time> stamps = {nextImage()};
  while (stamps.size() < 20) {
    const double torque = 0.1 * static_cast<double>(stamps.size());
    client_->publish(stamps.back(), {torque});
    // Every third torque is late, because the image has another answer already.
    if (stamps.size() % 3 == 0) client_->publish(stamps[stamps.size() - 2], {-torque});
    stamps.push_back(nextImage());
  }
  ASSERT_TRUE(client_->waitUntil([&stamps] {
    return !client_->truths.empty() && client_->truths.back().header.stamp >= stamps.back();
  }));
  int num_acted = 0;
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i) {
    const std::vector<double> applied = appliedAt(stamps[i]);
    if (applied.empty()) continue;
    const auto& truths = client_->truths;
    const auto next = std::find_if(truths.begin(), truths.end(), [&](const auto& truth) {
      return truth.header.stamp > stamps[i];
    });
    ASSERT_NE(next, truths.end());
    EXPECT_EQ(applied, next->effort) << "image " << i;
    ++num_acted;
  }
  EXPECT_GT(num_acted, 0);
}

TEST_F(Realtime, ATorqueThatIsLateOrLostActedAsTheAnswerToNoImage) {
  const ros::Time lost = nextImage();
  const ros::Time late = nextImage();
  const ros::Time next = nextImage();
  client_->publish(late, {1.5});
  EXPECT_EQ(appliedAt(lost), std::vector<double>{});
  EXPECT_EQ(appliedAt(late), std::vector<double>{});
  EXPECT_EQ(appliedAt(next), std::vector<double>{});
  // The torque acts all the same, and the ground truth shows it later.
  EXPECT_TRUE(client_->waitUntil([] { return numFramesWithEffort(1.5) >= 1; }));
}

TEST_F(Realtime, ATorqueForAnOlderImageDoesNotReplaceOneForANewerImage) {
  const ros::Time older = nextImage();
  const ros::Time newer = nextImage();
  client_->publish(newer, {1.25});
  client_->publish(older, {-1.25});
  ASSERT_TRUE(waitForEffort(1.25));
  ASSERT_TRUE(waitForEffort(0.0));
  EXPECT_EQ(numFramesWithEffort(-1.25), 0);
}

TEST_F(Realtime, SwitchesTheMotorOffUntilTheNextResetAtATorqueThatIsNotFinite) {
  client_->publish(ros::Time(5, 0), {4.0});
  client_->publish(ros::Time(5, 0), {std::numeric_limits<double>::quiet_NaN()});
  client_->publish(ros::Time(5, 0), {4.0});
  ASSERT_TRUE(client_->waitForLog("torque refused: " + ros::this_node::getName()));
  ASSERT_TRUE(client_->waitForImages(client_->images.size() + 3));
  EXPECT_LE(numFramesWithEffort(4.0), 1);  // one if a period ended between the first two messages
  client_->reset(0, {0.0, 0.0});
  client_->publish(ros::Time(5, 0), {3.0});
  EXPECT_TRUE(waitForEffort(3.0));
}

TEST_F(Realtime, CancelsTheTrialAtATorqueThatIsRefusedOnce) {
  int num_cancelled = 0;
  ros::NodeHandle nh;
  const ros::Subscriber cancel = nh.subscribe<actionlib_msgs::GoalID>(
      "run_trial/cancel", 10, [&](const actionlib_msgs::GoalIDConstPtr&) { ++num_cancelled; });
  ASSERT_TRUE(client_->waitUntil([&] { return cancel.getNumPublishers() == 1; }));
  ASSERT_TRUE(client_->waitUntil([&] {  // repeated until the publisher is connected, too
    client_->reset(0, {0.0, 0.0});
    client_->publish(ros::Time(5, 0), {1e300});
    return num_cancelled > 0;
  }));
  ASSERT_TRUE(client_->waitForImages(client_->images.size() + 3));
  const int before = num_cancelled;
  client_->reset(0, {0.0, 0.0});
  client_->publish(ros::Time(5, 0), {1e300});
  client_->publish(ros::Time(5, 0), {1e300});
  ASSERT_TRUE(client_->waitForImages(client_->images.size() + 3));
  EXPECT_EQ(num_cancelled, before + 1);
}

TEST_F(Realtime, ResetsAtAnyTimeAndDropsTheTorqueOnHold) {
  client_->publish(ros::Time(5, 0), {5.0});
  ASSERT_TRUE(waitForEffort(5.0));
  const ddm_msgs::Reset::Response response = client_->reset(0, {2.0, 0.0});
  ASSERT_TRUE(response.success);
  const auto isFirst = [&response](const auto& truth) {
    return truth.header.stamp == response.start;
  };
  std::vector<sensor_msgs::JointState>& truths = client_->truths;
  ASSERT_TRUE(client_->waitUntil([&] {
    const auto first = std::find_if(truths.begin(), truths.end(), isFirst);
    return truths.end() - first >= 3;
  }));
  const auto first = std::find_if(truths.begin(), truths.end(), isFirst);
  EXPECT_EQ(first->position[0], 2.0);
  EXPECT_EQ((first + 1)->position[0], 2.0);  // without gravity and torque the rod stays
  EXPECT_EQ((first + 1)->effort[0], 0.0);
}

}  // namespace
}  // namespace ddm
