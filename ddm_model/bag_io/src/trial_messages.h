// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>
#include <ddm_msgs/Torque.h>
#include <ros/time.h>
#include <sensor_msgs/Image.h>

#include <map>
#include <string>
#include <vector>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// Takes messages in any order. All functions throw std::runtime_error with stamp, fault and
/// remedy.
class TrialMessages {
 public:
  /// @param image_size  images are converted to image_size x image_size grey values
  explicit TrialMessages(int image_size) : image_size_(image_size) {}

  void takeImage(const sensor_msgs::Image& image);
  void takeTorque(const ddm_msgs::Torque& torque);
  void takeGoal(const sensor_msgs::Image& image);

  /// The images with a torque of the same stamp as frames, in the order of the stamps.
  BagContent frames() const;

 private:
  int image_size_;
  std::map<ros::Time, Grey> images_;
  std::map<ros::Time, std::vector<double>> torques_;
  Grey goal_;
  std::string camera_;
};

}  // namespace ddm
