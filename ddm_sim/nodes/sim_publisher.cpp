// What the simulator shows on the wire: camera image, ground truth, goal image and clock.
// SPDX-License-Identifier: BSD-3-Clause
#include "sim_publisher.h"

#include <image_transport/image_transport.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/Image.h>

#include <utility>

#include "ddm_images/image_codec.h"
#include "ddm_msgs/topics.h"
#include "joint_state.h"

namespace ddm {
namespace {

constexpr char kFrameId[] = "camera";
constexpr int kQueueSize = 10;
constexpr int kGroundTruthQueueSize = 1000;  // several frames are told at a time

}  // namespace

SimPublisher::SimPublisher(ros::NodeHandle nh, const Plant& plant, bool clock) : plant_(plant) {
  if (clock) clock_ = nh.advertise<rosgraph_msgs::Clock>("/clock", 1, /*latch=*/true);
  goal_image_ = nh.advertise<sensor_msgs::Image>(topics::kGoalImage, 1, /*latch=*/true);
  ground_truth_ =
      nh.advertise<sensor_msgs::JointState>(topics::kGroundTruth, kGroundTruthQueueSize);
  image_ = image_transport::ImageTransport(nh).advertise(topics::kImage, kQueueSize);
}

void SimPublisher::publishGoal(const std::vector<std::uint8_t>& photograph,
                               const ros::Time& stamp) const {
  goal_image_.publish(encodeImage(photograph, plant_.imageSize(), stamp, kFrameId));
}

void SimPublisher::publishClock(const ros::Time& stamp) const {
  rosgraph_msgs::Clock clock;
  clock.clock = stamp;
  clock_.publish(clock);
}

void SimPublisher::publishFrame(const Eigen::VectorXd& applied,
                                const std::vector<std::uint8_t>& photograph,
                                const ros::Time& stamp) {
  image_.publish(encodeImage(photograph, plant_.imageSize(), stamp, kFrameId));
  sensor_msgs::JointState joints = jointStateOf(plant_, applied);
  joints.header.stamp = stamp;
  kept_.push_back(std::move(joints));
}

void SimPublisher::publishGroundTruth() {
  for (const sensor_msgs::JointState& joints : kept_) ground_truth_.publish(joints);
  kept_.clear();
}

}  // namespace ddm
