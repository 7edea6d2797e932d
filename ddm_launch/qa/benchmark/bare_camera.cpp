// bare_camera: publishes an image as soon as the last one has its torque, and times the round
// trips. SPDX-License-Identifier: BSD-3-Clause
#include <ddm_images/image_codec.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "interval_log.h"

namespace {

constexpr int kImageSize = 51;
constexpr int kQueue = 10;

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "bare_camera");
  ros::NodeHandle nh;
  ros::NodeHandle private_nh("~");
  const int num_frames = private_nh.param("num_frames", 3000);
  const std::string out = private_nh.param<std::string>("out", "");
  const std::vector<std::uint8_t> grey(kImageSize * kImageSize, 100);
  const ros::Publisher images = nh.advertise<sensor_msgs::Image>(ddm::topics::kImage, kQueue);
  ddm::IntervalLog log;
  ros::Time stamp(1, 0);
  const auto show = [&] {
    stamp += ros::Duration(0.2);
    images.publish(ddm::encodeImage(grey, kImageSize, stamp, "camera"));
  };
  const ros::Subscriber torques = nh.subscribe<ddm_msgs::Torque>(
      ddm::topics::kTorque, kQueue,
      [&](const ddm_msgs::TorqueConstPtr& torque) {
        if (torque->header.stamp != stamp) return;
        log.tick();
        if (log.numEvents() >= num_frames + ddm::IntervalLog::kEvents) {
          ros::shutdown();
        } else {
          show();
        }
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  const ros::WallTimer start = nh.createWallTimer(ros::WallDuration(0.05), [&](const auto&) {
    if (stamp == ros::Time(1, 0) && images.getNumSubscribers() > 0 &&
        torques.getNumPublishers() > 0)
      show();
  });
  ros::spin();
  try {
    log.write(out);
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM("bare_camera: " << error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
