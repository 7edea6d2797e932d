// Publishes torques to the effort controllers of ros_control.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

#include <vector>

#include "ddm_msgs/topics.h"

namespace ddm {

/// Publishes the torques of all motors: as std_msgs/Float64 on `effort_command` for one motor, as
/// std_msgs/Float64MultiArray on `group_effort_command` for several motors.
class EffortPublisher {
 public:
  EffortPublisher(ros::NodeHandle nh, int num_motors)
      : num_motors_(num_motors),
        publisher_(num_motors == 1 ? nh.advertise<std_msgs::Float64>(topics::kEffortCommand, kQueue)
                                   : nh.advertise<std_msgs::Float64MultiArray>(
                                         topics::kGroupEffortCommand, kQueue)) {}

  /// @param torque  one value per motor [N m]                                        [num_motors]
  void publish(const std::vector<double>& torque) {
    if (num_motors_ == 1) {
      std_msgs::Float64 message;
      message.data = torque.front();
      publisher_.publish(message);
    } else {
      std_msgs::Float64MultiArray message;
      message.data = torque;
      publisher_.publish(message);
    }
  }

  int numSubscribers() const { return static_cast<int>(publisher_.getNumSubscribers()); }

 private:
  static constexpr int kQueue = 10;

  int num_motors_;
  ros::Publisher publisher_;
};

}  // namespace ddm
