// Torques for the effort controllers of ros_control.
// SPDX-License-Identifier: BSD-3-Clause
#include "effort_publisher.h"

#include <ddm_msgs/topics.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

namespace ddm {
namespace {

constexpr int kQueue = 10;

}  // namespace

EffortPublisher::EffortPublisher(ros::NodeHandle nh, int torque_dim)
    : torque_dim_(torque_dim),
      publisher_(torque_dim == 1 ? nh.advertise<std_msgs::Float64>(topics::kEffortCommand, kQueue)
                                 : nh.advertise<std_msgs::Float64MultiArray>(
                                       topics::kGroupEffortCommand, kQueue)) {}

void EffortPublisher::publish(const Eigen::VectorXd& torque) {
  if (torque_dim_ == 1) {
    std_msgs::Float64 message;
    message.data = torque[0];
    publisher_.publish(message);
  } else {
    std_msgs::Float64MultiArray message;
    message.data.assign(torque.data(), torque.data() + torque.size());
    publisher_.publish(message);
  }
}

}  // namespace ddm
