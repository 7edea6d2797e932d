// Tests of the bag reader: how frames are found, and where segments begin.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_bag_io/bag_reader.h"

#include <gtest/gtest.h>

#include "toy_bags.h"

namespace ddm {
namespace {

using testing::imageMessage;
using testing::torqueMessage;
using testing::ToyBag;
using testing::toyImage;

using BagReader = testing::BagTest;
using Sizes = std::vector<Eigen::Index>;

TEST_F(BagReader, GivesBackTheTrialThatWasWritten) {
  const DataSet trial = testing::toyTrial(20, 1);
  testing::writeTrial(path_, trial);
  const BagContent content = read();
  EXPECT_EQ(content.data.pixels(0, 20), trial.pixels(0, 20));
  EXPECT_EQ(content.data.torques(), trial.torques());
  EXPECT_EQ(content.data.segments().size(), 1U);
  EXPECT_EQ(content.data.goal(), toyImage(3.0));
  EXPECT_EQ(content.camera, "8x8 mono8");
  EXPECT_EQ(content.images_without_torque.size(), 0u);
  EXPECT_EQ(content.torques_without_image.size(), 0u);
  ASSERT_EQ(content.times.size(), 20U);
  EXPECT_EQ(content.times[0], 0.0);
  EXPECT_NEAR(content.times[19], 19 * 0.2, 1e-6);
  EXPECT_NEAR(content.interval, 0.2, 1e-6);
}

TEST_F(BagReader, PairsByHeaderStampWhateverTheOrderOfRecording) {
  {
    ToyBag bag(path_);
    bag.write("torque", 5.0, torqueMessage(1.2, {12.0}));
    bag.image(5.1, imageMessage(1.0, toyImage(0.0)));
    bag.image(5.2, imageMessage(1.2, toyImage(0.2)));
    bag.write("torque", 5.3, torqueMessage(1.0, {10.0}));
  }
  const DataSet data = read().data;
  ASSERT_EQ(data.numFrames(), 2);
  EXPECT_EQ(data.torques(), Eigen::RowVector2d(10.0, 12.0));
  EXPECT_EQ(data.image(1)[5], toyImage(0.2)[5]);
}

TEST_F(BagReader, AnImageWithoutTorqueSplitsTheTrial) {
  {
    ToyBag bag(path_);
    for (int t = 0; t < 10; ++t) {
      bag.image(1.0 + 0.2 * t, 0.1 * t);
      if (t == 8) bag.torque(1.0 + 0.2 * t, {});  // no torque acted
      if (t != 4 && t != 8) bag.torque(1.0 + 0.2 * t, {1.0});
    }
    bag.torque(50.0, {1.0});
  }
  EXPECT_EQ(segmentSizes(), (Sizes{4, 3, 1}));
  EXPECT_EQ(read().images_without_torque.size(), 2u);
  EXPECT_EQ(read().torques_without_image.size(), 1u);
  EXPECT_TRUE(read().notes.empty());
}

TEST_F(BagReader, WhatHasNoPartnerIsToldOfBagsThatOthersRecorded) {
  {
    ToyBag bag(path_);
    for (int t = 0; t < 10; ++t) {
      const double stamp = 1.0 + 0.2 * t;
      bag.image(stamp + 0.01, imageMessage(stamp, toyImage(0.1 * t)));
      if (t != 4) bag.torque(stamp, {1.0});
    }
    bag.torque(50.0, {1.0});
  }
  EXPECT_TRUE(notes({{"1 of 10 images", "1 of 10 torques", "stamp each"},
                     {"at 1 place(s)", "after 1.6", "2 segments"}}));
}

TEST_F(BagReader, AGapInTimeSplitsTheTrialAndJitterDoesNot) {
  {
    ToyBag bag(path_);
    double stamp = 1.0;
    for (int t = 0; t < 12; ++t) {
      stamp += t == 5 ? 0.4 : (t % 2 == 0 ? 0.17 : 0.23);
      bag.frame(stamp, 0.1 * t, 1.0);
    }
  }
  EXPECT_EQ(segmentSizes(), (Sizes{5, 7}));
}

TEST_F(BagReader, FindsTopicsUnderAnyNamespaceAsPlainRosbagRecordWritesThem) {
  for (const std::string& prefix : {std::string("/"), std::string("/robot/left/")}) {
    options_ = BagOptions();
    BagOptions topics;
    topics.image_topic = prefix + topics.image_topic;
    topics.torque_topic = prefix + topics.torque_topic;
    topics.goal_topic = prefix + topics.goal_topic;
    testing::writeTrial(path_, testing::toyTrial(5, 1), /*with_goal=*/true, topics);
    EXPECT_EQ(read().data.numFrames(), 5) << prefix;
    EXPECT_TRUE(read().data.hasGoal()) << prefix;
    options_ = topics;
    EXPECT_EQ(read().data.numFrames(), 5) << prefix;
  }
}

TEST_F(BagReader, DoesNotTakeHalfAWordForATopic) {
  BagOptions topics;
  topics.torque_topic = "/desired_torque";
  testing::writeTrial(path_, testing::toyTrial(5, 1), /*with_goal=*/true, topics);
  EXPECT_TRUE(isRefused({"no topic torque", "/desired_torque", "data_set/torque_topic"}));
}

TEST_F(BagReader, AsksWhichOfTwoTopicsIsMeantAndTakesTheAnswer) {
  {
    ToyBag bag(path_);
    bag.image(1.0, 0.0);
    bag.write("/left/torque", 1.0, torqueMessage(1.0, {1.0}));
    bag.write("/right/torque", 1.0, torqueMessage(1.0, {2.0}));
  }
  EXPECT_TRUE(isRefused({"/left/torque", "/right/torque", "data_set/torque_topic"}));
  options_.torque_topic = "/right/torque";
  EXPECT_EQ(read().data.torques()(0, 0), 2.0);
}

TEST_F(BagReader, ConvertsImagesOfAnotherSizeAndEncoding) {
  {
    ToyBag bag(path_);
    for (int t = 0; t < 5; ++t) {
      const double stamp = 1.0 + 0.2 * t;
      sensor_msgs::Image image = imageMessage(stamp, Image(24 * 24, 100), 24);
      image.encoding = "rgb8";
      image.step = 3 * 24;
      image.data.assign(3 * 24 * 24, 100);
      bag.image(stamp, image);
      bag.torque(stamp, {1.0});
    }
    bag.goal(9.0, imageMessage(9.0, Image(16 * 16, 40), 16));
  }
  const BagContent content = read();
  EXPECT_EQ(content.camera, "24x24 rgb8");
  EXPECT_EQ(content.data.numPixels(), 64);
  EXPECT_EQ(content.data.image(2)[17], 100);
  EXPECT_EQ(content.data.goal(), Image(64, 40));
}

TEST_F(BagReader, TakesTheLastGoalImageAndDoesWithoutOne) {
  {
    ToyBag bag(path_);
    bag.goal(1.0, imageMessage(1.0, toyImage(1.0)));
    bag.goal(2.0, imageMessage(2.0, toyImage(2.0)));
    bag.frame(1.0, 0.0, 0.0);
  }
  EXPECT_EQ(read().data.goal(), toyImage(2.0));
  testing::writeTrial(path_, testing::toyTrial(5, 1), /*with_goal=*/false);
  EXPECT_FALSE(read().data.hasGoal());
}

TEST_F(BagReader, ForgivesMessagesThatWereRecordedTwice) {
  {
    ToyBag bag(path_);
    for (int t = 0; t < 5; ++t) {
      bag.frame(1.0 + 0.2 * t, 0.1 * t, 1.0);
      bag.frame(1.0 + 0.2 * t, 0.1 * t, 1.0);
    }
  }
  EXPECT_EQ(segmentSizes(), (Sizes{5}));
}

TEST_F(BagReader, AClockThatIsSetBackChangesNeitherOrderNorPairs) {
  {
    ToyBag bag(path_);
    for (int t = 0; t < 10; ++t) {
      const double recorded = 20.0 + 0.2 * t, stamp = recorded - (t < 6 ? 0.0 : 0.9);
      bag.image(recorded, imageMessage(stamp, toyImage(0.1 * t)));
      bag.write("torque", recorded, torqueMessage(stamp, {1.0 * t}));
    }
  }
  const BagContent content = read();
  EXPECT_EQ(segmentSizes(), (Sizes{10}));
  for (int t = 0; t < 10; ++t) EXPECT_EQ(content.data.torques()(0, t), t);
  EXPECT_EQ(content.data.image(7), toyImage(0.7));
  EXPECT_NEAR(content.times[9], 1.8, 1e-6);
  EXPECT_TRUE(notes({{"go back", "21.0", "20.3"}}));
}

TEST_F(BagReader, ATopicCannotBeTwoThings) {
  testing::writeTrial(path_, testing::toyTrial(5, 1));
  options_.goal_topic = "image_raw";  // found in the namespace /camera
  EXPECT_TRUE(isRefused({"camera/image_raw", "data_set/goal_topic"}));
}

}  // namespace
}  // namespace ddm
