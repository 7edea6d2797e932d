// main() of a test that is a ROS node. Include it in exactly one file of a program.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "test");
  const ros::NodeHandle nh;  // keeps the node alive between tests
  return RUN_ALL_TESTS();
}
