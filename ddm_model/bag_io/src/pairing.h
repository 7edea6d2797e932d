// Which torque acted after which image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ddm {

/// [s], may be negative. A difference of ros::Time throws where clocks are 68 years apart.
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  const std::int64_t seconds = std::int64_t{to.sec} - from.sec - (to.nsec < from.nsec ? 1 : 0);
  const std::int64_t rest =
      std::int64_t{to.nsec} - from.nsec + (to.nsec < from.nsec ? 1000000000 : 0);
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
}

/// An image of a bag.
struct TimedImage {
  std::size_t number;  ///< in the order of the file
  ros::Time stamp;     ///< pairByStamp(): by which its torque is found
  ros::Time time;      ///< by which images are ordered and gaps are found
  ros::Time act;       ///< pairInTime(): when it was there, by the clock of the torques
};

struct TimedTorque {
  ros::Time stamp;             ///< of the header; 0: there is none
  ros::Time recorded;          ///< when it arrived
  ros::Time time;              ///< the one of both that counts
  std::vector<double> torque;  ///< one of each motor [N m]
};

struct Pairs {
  /// An image and the torque that acted until the next one.
  struct Frame {
    std::size_t image;           ///< its number
    ros::Time time;              ///< of the image
    std::vector<double> torque;  ///< [N m]
    bool new_segment;            ///< nothing of the frame before leads to it
  };
  std::vector<Frame> frames;  ///< by their times
  std::vector<ros::Time> images_without_torque;
  std::vector<ros::Time> torques_without_image;
  std::size_t num_held = 0;  ///< frames whose torque is older than a usual interval between torques
  double usual_age = 0.0;    ///< such an interval [s]
  double longest_held = 0.0;  ///< age of the oldest torque when its frame ends [s]

  /// Median interval between frames [s]; 0 if there are fewer than two.
  double interval() const;
};

/// Pairs what has the same stamp, as this project records it. A new segment begins after an image
/// without a torque, and after a gap of more than 1.5 times the median interval.
/// @param images  by their times
/// @throws std::runtime_error if two different torques, or two images of a torque, have one stamp
Pairs pairByStamp(const std::vector<TimedImage>& images, std::vector<TimedTorque> torques);

/// Takes images dt apart, to a quarter of dt, and with each the torque that is in force when the
/// next one is due. A torque is in force until there is another, as controllers hold it. A new
/// segment begins where an image is missing.
/// @param images  by their times
/// @param dt      [s], > 0
/// @throws std::runtime_error if images do not come at a multiple of dt
Pairs pairInTime(const std::vector<TimedImage>& images, std::vector<TimedTorque> torques,
                 double dt);

}  // namespace ddm
