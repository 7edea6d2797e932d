// Measures round trips of images and torques between nodes, for `rosrun ddm_launch qa benchmark`.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_common/image_codec.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "ros_driver.h"

namespace ddm {
namespace {

constexpr int kImageSize = 51;
constexpr int kQueue = 1000;
constexpr double kTimeout = 30.0;  // [s]
const ros::TransportHints kNoDelay = ros::TransportHints().tcpNoDelay();

class Stopwatch {
 public:
  /// Reports that `number` round trips are complete. Ignores the first kWarmUp round trips, in
  /// which connections and caches are new.
  void tick(int number) {
    if (number < kWarmUp) return;
    last_ = Clock::now();
    num_last_ = number;
    if (num_first_ > 0) return;
    first_ = last_;
    num_first_ = number;
  }

  /// Mean time of a round trip [us].
  /// @throws std::runtime_error if fewer than two round trips have been reported
  double mean() const {
    if (num_last_ <= num_first_) throw std::runtime_error("no round trip was timed");
    return std::chrono::duration<double, std::micro>(last_ - first_).count() /
           (num_last_ - num_first_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kWarmUp = 100;

  Clock::time_point first_, last_;
  int num_first_ = 0, num_last_ = 0;
};

/// Times the real nodes through the feedback of their trial. Subscribing to each image would add
/// load.
void timeLockstep(const ros::NodeHandle& nh, int num_frames, Stopwatch* watch) {
  RosDriver::Peers peers;
  peers.recorder = peers.trainer = false;
  RosDriver driver(nh, kTimeout, peers);
  TrialRequest request;
  request.num_steps = num_frames;
  request.epsilon = 1.0;
  driver.runTrial(request, [&](double fraction) {
    watch->tick(static_cast<int>(std::lround(fraction * num_frames)));
  });
}

void timeBareCamera(ros::NodeHandle* nh, int num_frames, Stopwatch* watch) {
  const std::vector<std::uint8_t> grey(kImageSize * kImageSize, 100);
  const ros::Publisher images = nh->advertise<sensor_msgs::Image>(topics::kImage, kQueue);
  ros::Time stamp(1, 0);
  int num_answered = 0;
  const auto show = [&] {
    stamp += ros::Duration(0.2);
    images.publish(encodeImage(grey, kImageSize, stamp, "camera"));
  };
  const auto on_torque = [&](const ddm_msgs::TorqueConstPtr& torque) {
    if (torque->header.stamp != stamp) return;
    watch->tick(++num_answered);
    if (num_answered < num_frames) return show();
    ros::shutdown();
  };
  const ros::Subscriber torques = nh->subscribe<ddm_msgs::Torque>(
      topics::kTorque, kQueue, on_torque, ros::VoidConstPtr(), kNoDelay);
  const ros::WallTimer start = nh->createWallTimer(ros::WallDuration(0.05), [&](const auto&) {
    if (stamp == ros::Time(1, 0) && images.getNumSubscribers() && torques.getNumPublishers())
      show();
  });
  ros::spin();
}

void answerImages(ros::NodeHandle* nh) {
  const ros::Publisher torques = nh->advertise<ddm_msgs::Torque>(topics::kTorque, kQueue);
  const auto on_image = [&torques](const sensor_msgs::ImageConstPtr& image) {
    ddm_msgs::Torque torque;
    torque.header.stamp = image->header.stamp;
    torque.torque = {1.0};
    torques.publish(torque);
  };
  const ros::Subscriber images = nh->subscribe<sensor_msgs::Image>(topics::kImage, kQueue, on_image,
                                                                   ros::VoidConstPtr(), kNoDelay);
  ros::spin();
}

}  // namespace

/// Runs one node of a loop if the first argument is its role. The second argument is the number of
/// round trips. The node that measures them prints the mean [us].
///
///   lockstep         lets the real nodes run a random trial, without recorder
///   bare_camera      publishes an image as soon as the torque for the previous image arrives
///   bare_controller  answers each image with a torque
///
/// @return false if the first argument is not a role
/// @throws std::runtime_error if a node does not appear or no round trip was timed
bool timesRoundTrips(int argc, char** argv) {
  const std::string role = argv[1];
  if (role != "lockstep" && role != "bare_camera" && role != "bare_controller") return false;
  ros::init(argc, argv, role);
  ros::NodeHandle nh;
  if (role == "bare_controller") {
    answerImages(&nh);
    return true;
  }
  const int num_frames = argc > 2 ? std::stoi(argv[2]) : 3000;
  Stopwatch watch;
  if (role == "bare_camera") {
    timeBareCamera(&nh, num_frames, &watch);
  } else {
    timeLockstep(nh, num_frames, &watch);
  }
  std::cout << watch.mean() << "\n";
  return true;
}

}  // namespace ddm
