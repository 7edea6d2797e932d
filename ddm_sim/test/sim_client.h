// Test client of sim_node: collects its messages and waits for conditions with a time limit.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Reset.h>
#include <ddm_msgs/Torque.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/JointState.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "ddm_msgs/topics.h"

namespace ddm {

class SimClient {
 public:
  SimClient() {
    image_ = nh_.subscribe(topics::kImage, 1000, &SimClient::onImage, this);
    truth_ = nh_.subscribe(topics::kGroundTruth, 1000, &SimClient::onTruth, this);
    goal_ = nh_.subscribe(topics::kGoalImage, 10, &SimClient::onGoal, this);
    applied_ = nh_.subscribe(topics::kAppliedTorque, 1000, &SimClient::onApplied, this);
    clock_ = nh_.subscribe("/clock", 1000, &SimClient::onClock, this);
    log_ = nh_.subscribe("/rosout", 1000, &SimClient::onLog, this);
    torque_ = nh_.advertise<ddm_msgs::Torque>(topics::kTorque, 1000);
    reset_ = nh_.serviceClient<ddm_msgs::Reset>(topics::kReset);
  }

  /// Waits until all topics are connected, including the log, in which tests find refused resets.
  /// Begins no episode.
  bool connect() {
    if (!reset_.waitForExistence(ros::Duration(-1))) return false;
    return waitUntil([this] {
      ddm_msgs::Reset refused;
      refused.request.start = {1.0, 2.0, 3.0};
      reset_.call(refused);
      return torque_.getNumSubscribers() == 1 && image_.getNumPublishers() == 1 &&
             truth_.getNumPublishers() == 1 && applied_.getNumPublishers() == 1 &&
             logged("reset refused");
    });
  }

  /// Handles callbacks until the condition holds.
  /// @return false if the condition does not hold within the limit
  bool waitUntil(const std::function<bool()>& condition, double limit = 12.0) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(limit);
    while (!condition()) {
      if (ros::WallTime::now() > end || !ros::ok()) return false;
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
    }
    return true;
  }

  bool waitForImages(std::size_t count) {
    return waitUntil([this, count] { return images.size() >= count && truths.size() >= count; });
  }
  bool waitForLog(const std::string& part) {
    return waitUntil([this, part] { return logged(part); });
  }

  ddm_msgs::Reset::Response reset(std::uint32_t num_steps, const std::vector<double>& start = {},
                                  std::uint64_t seed = 0, std::uint32_t trial = 0) {
    ddm_msgs::Reset call;
    call.request.seed = seed;
    call.request.trial = trial;
    call.request.num_steps = num_steps;
    call.request.start = start;
    EXPECT_TRUE(reset_.call(call));
    return call.response;
  }

  void publish(const ros::Time& stamp, const std::vector<double>& torque) {
    ddm_msgs::Torque message;
    message.header.stamp = stamp;
    message.torque = torque;
    torque_.publish(message);
  }

  bool logged(const std::string& part) const {
    for (const std::string& line : log_lines) {
      if (line.find(part) != std::string::npos) return true;
    }
    return false;
  }

  void forget() {
    images.clear();
    truths.clear();
    applied.clear();
    log_lines.clear();
  }

  std::vector<sensor_msgs::Image> images;
  std::vector<sensor_msgs::JointState> truths;
  std::vector<ddm_msgs::Torque> applied;
  std::vector<sensor_msgs::Image> goals;
  std::vector<ros::Time> clocks;
  std::vector<std::string> log_lines;

 private:
  void onImage(const sensor_msgs::Image& image) { images.push_back(image); }
  void onTruth(const sensor_msgs::JointState& truth) { truths.push_back(truth); }
  void onApplied(const ddm_msgs::Torque& torque) { applied.push_back(torque); }
  void onGoal(const sensor_msgs::Image& goal) { goals.push_back(goal); }
  void onClock(const rosgraph_msgs::Clock& clock) { clocks.push_back(clock.clock); }
  void onLog(const rosgraph_msgs::Log& log) { log_lines.push_back(log.msg); }

  ros::NodeHandle nh_;
  ros::Subscriber image_, truth_, applied_, goal_, clock_, log_;
  ros::Publisher torque_;
  ros::ServiceClient reset_;
};

/// Fixture for tests of one sim_node. The tests share a client, which discards its messages before
/// each test.
class SimNodeTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    client_ = std::make_unique<SimClient>();
    ASSERT_TRUE(client_->connect());
  }
  static void TearDownTestSuite() { client_.reset(); }
  void SetUp() override { client_->forget(); }

  inline static std::unique_ptr<SimClient> client_;
};

}  // namespace ddm
