// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_images/image_codec.h>
#include <ddm_model/data_set.h>
#include <ros/time.h>
#include <sensor_msgs/Image.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "ddm_bag_io/bag_reader.h"
#include "pairing.h"
#include "torque_reader.h"

namespace ddm {

/// Takes messages in any order, in two rounds: only images that become frames are decoded. All
/// functions throw std::runtime_error with stamp, fault and remedy.
class TrialMessages {
 public:
  /// @param image_size  images are converted to image_size x image_size grey values
  TrialMessages(int image_size, const BagOptions& options)
      : image_size_(image_size), options_(options) {}

  /// First round.
  void takeImageTime(const ros::Time& time);
  void takeTorque(TimedTorque torque);
  /// Ends it. dt: see BagOptions [s]; 0: what belongs together has the same stamp.
  void pair(double dt);

  /// Second round. Whether the image of that time becomes a frame.
  bool wants(const ros::Time& time) const { return images_.count(time) > 0; }
  /// @param encoding  as the camera sent it, for messages
  void takeImage(const ros::Time& time, const sensor_msgs::Image& image,
                 const std::string& encoding);
  void takeGoal(const sensor_msgs::Image& image);
  BagContent frames() const;

 private:
  Grey decode(const sensor_msgs::Image& image, const std::string& what) const;

  int image_size_;
  BagOptions options_;
  std::set<ros::Time> times_;         // of all images
  std::vector<TimedTorque> torques_;  // all
  Pairs pairs_;
  std::map<ros::Time, Grey> images_;  // of the frames; empty until they come
  Grey goal_;
  std::string camera_;
};

}  // namespace ddm
