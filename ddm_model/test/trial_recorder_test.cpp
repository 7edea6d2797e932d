// Tests of trial_recorder: complete bags under their names, incomplete ones as *.active.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/StartRecording.h>
#include <ddm_msgs/StopRecording.h>
#include <ddm_msgs/testing/node_main.h>
#include <ddm_msgs/topics.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <utility>

#include "ddm_bag_io/bag_reader.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_msgs/testing/temp_folder.h"
#include "toy_bags.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;
using testing::imageMessage;
using testing::torqueMessage;
using testing::toyImage;

const ros::WallDuration kLimit(20.0);

class TrialRecorderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService(topics::kStopRecording, ros::Duration(20.0)));
    const ros::WallTime end = ros::WallTime::now() + kLimit;
    const auto connected = [this] {
      return image_pub_.getNumSubscribers() == 1 && torque_pub_.getNumSubscribers() == 1 &&
             goal_pub_.getNumSubscribers() == 1;
    };
    while (!connected() && ros::WallTime::now() < end) ros::WallDuration(0.01).sleep();
    ASSERT_TRUE(connected());
  }

  bool start(const std::string& path, double after = 0.0) {
    ddm_msgs::StartRecording call;
    call.request.path = path;
    call.request.after = ros::Time(after);
    EXPECT_TRUE(ros::service::call(topics::kStartRecording, call));
    message_ = call.response.message;
    return call.response.success;
  }
  static ddm_msgs::StopRecording::Response stop(std::uint32_t num_steps, int last = -1,
                                                const ros::Time& goal = {}) {
    ddm_msgs::StopRecording call;
    call.request.num_steps = num_steps;
    if (last >= 0) call.request.last = stampOf(last);
    call.request.goal = goal;
    EXPECT_TRUE(ros::service::call(topics::kStopRecording, call));
    return call.response;
  }
  /// @return the stop that waits for the rest of its trial, and the answer to the other one
  static std::pair<std::future<ddm_msgs::StopRecording::Response>,
                   ddm_msgs::StopRecording::Response>
  stopTwice(std::uint32_t num_steps) {
    const auto call = [num_steps] { return stop(num_steps); };
    auto one = std::async(std::launch::async, call);
    auto other = std::async(std::launch::async, call);
    const auto ended = [](auto& stopping) {
      return stopping.wait_for(std::chrono::milliseconds(5)) == std::future_status::ready;
    };
    while (!ended(one) && !ended(other)) continue;
    if (ended(one)) std::swap(one, other);
    return {std::move(one), other.get()};
  }
  static ros::Time stampOf(int t) { return ros::Time(1.0 + 0.2 * t); }
  void publishImage(int t) {
    image_pub_.publish(imageMessage(stampOf(t).toSec(), toyImage(0.1 * t)));
  }
  void publishTorque(int t) { torque_pub_.publish(torqueMessage(stampOf(t).toSec(), {0.5 * t})); }
  void publishNoTorque(int t) { torque_pub_.publish(torqueMessage(stampOf(t).toSec(), {})); }
  void publishFrames(int count) {
    for (int t = 0; t < count; ++t) {
      publishImage(t);
      publishTorque(t);
    }
  }

  const testing::TempFolder folder_;
  const std::string path_ = folder_.file("trial.bag");
  std::string message_;
  ros::NodeHandle nh_;
  ros::Publisher image_pub_ = nh_.advertise<sensor_msgs::Image>(topics::kImage, 1000);
  ros::Publisher torque_pub_ = nh_.advertise<ddm_msgs::Torque>(topics::kAppliedTorque, 1000);
  ros::Publisher goal_pub_ = nh_.advertise<sensor_msgs::Image>(topics::kGoalImage, 1, true);
};

TEST_F(TrialRecorderTest, RecordsATrialAndRenamesItsBag) {
  ASSERT_TRUE(start(path_)) << message_;
  EXPECT_TRUE(fs::exists(path_ + ".active"));
  publishFrames(10);
  const auto response = stop(10);
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.images, 10U);
  EXPECT_EQ(response.torques, 10U);
  EXPECT_FALSE(fs::exists(path_ + ".active"));
  const DataSet data = readBag(path_, testing::kToySize, BagOptions()).data;
  EXPECT_EQ(data.numFrames(), 10);
  EXPECT_EQ(data.segments().size(), 1U);
  EXPECT_EQ(data.torques()(0, 9), 4.5);
}

TEST_F(TrialRecorderTest, PutsTheGoalImageIntoEachBagOnceItHasSeenIt) {
  goal_pub_.publish(imageMessage(0.0, toyImage(3.0)));
  const auto recordedGoal = [this](const std::string& name) {
    EXPECT_TRUE(start(folder_.file(name))) << message_;
    publishFrames(3);
    EXPECT_TRUE(stop(3).success);
    return readBag(folder_.file(name), testing::kToySize, BagOptions()).data.goal();
  };
  const ros::WallTime end = ros::WallTime::now() + kLimit;
  while (recordedGoal("early.bag") != toyImage(3.0)) ASSERT_LT(ros::WallTime::now(), end);
  EXPECT_EQ(recordedGoal("next.bag"), toyImage(3.0));
  EXPECT_EQ(recordedGoal("one_more.bag"), toyImage(3.0));
}

TEST_F(TrialRecorderTest, RecordsTheGoalOfTheTrialThoughItComesAfterTheFrames) {
  goal_pub_.publish(imageMessage(0.5, toyImage(3.0)));
  ASSERT_TRUE(start(path_)) << message_;
  publishFrames(3);
  std::future<ddm_msgs::StopRecording::Response> stopped =
      std::async(std::launch::async, [] { return stop(3, /*last=*/2, /*goal=*/ros::Time(0.75)); });
  goal_pub_.publish(imageMessage(0.75, toyImage(2.0)));
  EXPECT_TRUE(stopped.get().success);
  EXPECT_EQ(readBag(path_, testing::kToySize, BagOptions()).data.goal(), toyImage(2.0));
}

TEST_F(TrialRecorderTest, RefusesATrialWithoutItsGoal) {
  EXPECT_TRUE(testing::names(stop(3).message, {"start_recording"})) << "nothing is recorded yet";
  ASSERT_TRUE(start(path_)) << message_;
  publishFrames(3);
  const auto response = stop(3, /*last=*/2, /*goal=*/ros::Time(0.875));
  EXPECT_FALSE(response.success);
  EXPECT_TRUE(testing::names(response.message,
                             {"goal image with stamp 0.875", "/goal_image", "within 5 s"}));
  EXPECT_TRUE(fs::exists(path_ + ".active"));
}

TEST_F(TrialRecorderTest, RefusesATrialWithAMissingTorqueAndKeepsWhatThereIs) {
  ASSERT_TRUE(start(path_)) << message_;
  publishFrames(4);
  publishImage(4);
  const auto response = stop(5);
  EXPECT_FALSE(response.success);
  EXPECT_TRUE(testing::names(response.message, {"of 5 ", "5 and 4", "4 pairs", "/applied_torque"}));
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_TRUE(fs::exists(path_ + ".active"));
}

TEST_F(TrialRecorderTest, ImagesThatNoTorqueAnsweredInTimeAreGapsOfTheTrial) {
  ASSERT_TRUE(start(path_)) << message_;
  for (int t = 0; t < 10; ++t) {
    publishImage(t);
    if (t == 4 || t == 9) {
      publishNoTorque(t);
    } else {
      publishTorque(t);
    }
  }
  const auto response = stop(10, /*last=*/9);
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.images, 10U);
  EXPECT_EQ(response.torques, 8U);
  EXPECT_EQ(response.pairs, 8U);
  const DataSet data = readBag(path_, testing::kToySize, BagOptions()).data;
  EXPECT_EQ(data.numFrames(), 8);
  ASSERT_EQ(data.segments().size(), 2U);
  EXPECT_EQ(data.torques()(0, 4), 2.5);  // of image 5: that of image 4 is in no frame
}

TEST_F(TrialRecorderTest, WaitsUntilItIsKnownWhatActedOnTheLastImage) {
  ASSERT_TRUE(start(path_)) << message_;
  publishFrames(4);
  publishImage(4);
  publishImage(5);  // after the trial
  auto stopping = std::async(std::launch::async, [] { return stop(4, /*last=*/4); });
  publishNoTorque(4);
  const auto response = stopping.get();
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.pairs, 4U);
}

TEST_F(TrialRecorderTest, RefusesATrialInWhichNoTorqueActed) {
  ASSERT_TRUE(start(path_)) << message_;
  for (int t = 0; t < 3; ++t) {
    publishImage(t);
    publishNoTorque(t);
  }
  const auto response = stop(3, /*last=*/2);
  EXPECT_FALSE(response.success);
  EXPECT_TRUE(testing::names(response.message, {"no torque", "3 images"}));
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(TrialRecorderTest, LeavesOutMessagesOfAnEarlierTrial) {
  ASSERT_TRUE(start(path_, /*after=*/1.3)) << message_;
  publishFrames(6);  // at 1.0, 1.2, ..., 2.0 s
  const auto response = stop(4);
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.images, 4U);
  EXPECT_EQ(response.torques, 4U);
  EXPECT_EQ(readBag(path_, testing::kToySize, BagOptions()).data.torques()(0, 0), 1.0);
}

TEST_F(TrialRecorderTest, ARecordingUnderWayCanBeToldThatNothingIsOfAnEarlierTrial) {
  ASSERT_TRUE(start(path_, /*after=*/100.0)) << message_;
  ASSERT_TRUE(start(/*path=*/"", /*after=*/0.0)) << message_;  // the clock was set back
  publishFrames(6);                                            // at 1.0, 1.2, ..., 2.0 s
  const auto response = stop(6, /*last=*/5);
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_EQ(response.images, 6U);
  EXPECT_EQ(readBag(path_, testing::kToySize, BagOptions()).data.numFrames(), 6);
}

TEST_F(TrialRecorderTest, ASecondStartLeavesTheFirstBagActive) {
  ASSERT_TRUE(start(path_)) << message_;
  const std::string second = folder_.file("second.bag");
  ASSERT_TRUE(start(second)) << message_;
  publishFrames(3);
  EXPECT_TRUE(stop(3).success);
  EXPECT_TRUE(fs::exists(path_ + ".active"));
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_EQ(readBag(second, testing::kToySize, BagOptions()).data.numFrames(), 3);
}

TEST_F(TrialRecorderTest, OneStopWaitsAtATimeAndAStartEndsIt) {
  ASSERT_TRUE(start(path_)) << message_;
  auto [waiting, refused] = stopTwice(5);
  EXPECT_TRUE(testing::names(refused.message, {"being stopped already"}));
  EXPECT_TRUE(start(folder_.file("second.bag"))) << message_;
  const auto response = waiting.get();
  EXPECT_FALSE(response.success);
  EXPECT_FALSE(response.message.empty());
  EXPECT_TRUE(stop(0).success);
}

TEST_F(TrialRecorderTest, AStartThatIsRefusedLeavesTheRecordingUnderWayAlone) {
  ASSERT_TRUE(start(path_)) << message_;
  publishFrames(3);
  const std::string there = folder_.file("there.bag");
  std::ofstream(there) << "an earlier trial";
  for (const std::string& wrong :
       {folder_.file("missing/trial.bag"), path_, there, folder_.file("x")}) {
    EXPECT_FALSE(start(wrong));
    EXPECT_TRUE(testing::names(message_, {wrong, "goes on"}));
  }
  publishImage(3);
  publishTorque(3);
  EXPECT_TRUE(stop(4).success);
  EXPECT_EQ(readBag(path_, testing::kToySize, BagOptions()).data.numFrames(), 4);
}

}  // namespace
}  // namespace ddm
