// Torques for the effort controllers of ros_control.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/ros.h>

#include <Eigen/Core>

namespace ddm {

/// Sends each torque to every motor: on `effort_command` as a std_msgs/Float64 where there is one
/// motor, on `group_effort_command` as a std_msgs/Float64MultiArray where there are several.
class EffortPublisher {
 public:
  EffortPublisher(ros::NodeHandle nh, int torque_dim);

  /// @param torque  one value per motor [N m]  [torque_dim]
  void publish(const Eigen::VectorXd& torque);

  /// Zero to every motor.
  void publishZero() { publish(Eigen::VectorXd::Zero(torque_dim_)); }

 private:
  int torque_dim_;
  ros::Publisher publisher_;
};

}  // namespace ddm
