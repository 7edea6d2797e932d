// Which torque acted after which image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <set>
#include <vector>

#include "torque_reader.h"

namespace ddm {

struct Pairs {
  /// An image and the torque that acted until the next one.
  struct Frame {
    ros::Time image;
    std::vector<double> torque;  ///< [N m]
    bool new_segment;            ///< nothing of the frame before leads to it
  };
  std::vector<Frame> frames;  ///< by their times
  std::vector<ros::Time> images_without_torque;
  std::vector<ros::Time> torques_without_image;

  /// Median interval between frames [s]; 0 if there are fewer than two.
  double interval() const;
};

/// Pairs what has the same stamp, as this project records it. A new segment begins after an image
/// without a torque, and after a gap of more than 1.5 times the median interval.
/// @throws std::runtime_error if two different torques have one stamp
Pairs pairByStamp(const std::set<ros::Time>& images, std::vector<TimedTorque> torques);

/// Takes images dt apart, to a quarter of dt, and with each the torque that is in force when the
/// next one is due. A torque is in force until there is another, but no longer than dt or 1.5 times
/// the median interval of all. A new segment begins where an image or its torque is missing.
/// @param dt  [s], > 0
/// @throws std::runtime_error if images are farther apart than that
Pairs pairInTime(const std::set<ros::Time>& images, std::vector<TimedTorque> torques, double dt);

}  // namespace ddm
