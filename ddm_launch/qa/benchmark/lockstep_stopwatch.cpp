// lockstep_stopwatch: has the real nodes run one random trial, and times frame after frame.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/topics.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>

#include "interval_log.h"
#include "ros_driver.h"

namespace {

constexpr int kQueue = 1000;
constexpr double kTimeout = 30.0;  // [s]

void run(const ros::NodeHandle& nh, int num_frames, const std::string& out) {
  ddm::IntervalLog log;
  std::mutex mutex;
  // RosDriver hears the ground truth anyway: one more callback, but no message that others lack.
  const ros::Subscriber frames = ros::NodeHandle(nh).subscribe<sensor_msgs::JointState>(
      ddm::topics::kGroundTruth, kQueue, [&](const sensor_msgs::JointStateConstPtr&) {
        const std::lock_guard<std::mutex> lock(mutex);
        log.tick();
      });
  ddm::RosDriver::Peers peers;
  peers.recorder = peers.trainer = false;
  ddm::RosDriver driver(nh, kTimeout, peers);
  ddm::TrialRequest request;
  request.num_steps = num_frames + ddm::IntervalLog::kEvents;
  request.epsilon = 1.0;
  driver.runTrial(request, [](double) {});
  const std::lock_guard<std::mutex> lock(mutex);
  log.write(out);
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "lockstep_stopwatch");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  ros::AsyncSpinner spinner(1);
  spinner.start();
  try {
    run(nh, private_nh.param("num_frames", 3000), private_nh.param<std::string>("out", ""));
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("lockstep_stopwatch: " << error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
