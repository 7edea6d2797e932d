// bare_controller: answers each image with a torque and does nothing else.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/topics.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>

int main(int argc, char** argv) {
  constexpr int kQueue = 10;
  ros::init(argc, argv, "bare_controller");
  ros::NodeHandle nh;
  const ros::Publisher torques = nh.advertise<ddm_msgs::Torque>(ddm::topics::kTorque, kQueue);
  const ros::Subscriber images = nh.subscribe<sensor_msgs::Image>(
      ddm::topics::kImage, kQueue,
      [&torques](const sensor_msgs::ImageConstPtr& image) {
        ddm_msgs::Torque torque;
        torque.header.stamp = image->header.stamp;
        torque.torque = {1.0};
        torques.publish(torque);
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
}
