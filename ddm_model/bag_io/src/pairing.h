// Which torque acted after which image.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ddm {

/// [s], may be negative. A difference of ros::Time throws where clocks are 68 years apart.
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  const std::int64_t seconds = std::int64_t{to.sec} - from.sec - (to.nsec < from.nsec ? 1 : 0);
  const std::int64_t rest =
      std::int64_t{to.nsec} - from.nsec + (to.nsec < from.nsec ? 1000000000 : 0);
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
}

/// A few messages may be late; only most of them tell of a clock. Of two middle values the lower one counts,
/// since a gap only ever lengthens an interval.
/// @param values  at least one
double median(std::vector<double> values);

/// [s]; 0 if there are fewer than two times.
double medianInterval(const std::vector<ros::Time>& times);

/// An image of a bag, whose pixels have not been decoded yet.
struct BagImage {
  ros::Time stamp;      ///< of the header; 0: there is none
  ros::Time recorded;   ///< when it arrived
  std::size_t number;   ///< in the order of the file
  std::size_t content;  ///< the same number for images with the same bytes
  ros::Time time{};     ///< set by pairUp(): by which images are ordered and gaps are found
  ros::Time act{};      ///< set by pairUp(): when it was there, by the clock of the torques
};

/// A torque of a bag.
struct BagTorque {
  ros::Time stamp;             ///< of the header; 0: there is none
  ros::Time recorded;          ///< when it arrived
  std::vector<double> torque;  ///< one of each motor [N m]
  ros::Time time{};            ///< set by pairUp(): the one of both times that counts
};

/// The frames of a bag, and what was left over.
struct Pairs {
  /// An image and the torque that acted until the next one.
  struct Frame {
    std::size_t image;           ///< its number
    ros::Time time;              ///< of the image
    std::vector<double> torque;  ///< [N m]
    bool new_segment;            ///< nothing of the frame before leads to it
  };
  std::vector<Frame> frames{};  ///< by their times
  std::vector<ros::Time> images_without_torque{};
  std::vector<ros::Time> torques_without_image{};
  double lag = 0.0;                  ///< of the torques' clock behind that of the images [s]
  bool of_others = false;            ///< whether the bag was not recorded by this project
  std::vector<std::string> notes{};  ///< what a user should know

  std::vector<ros::Time> times() const;
};

/// Pairs what has the same stamp, as this project records it. A new segment begins after an image without a
/// torque, and after a gap of more than 1.5 times the median interval.
/// @param images  by their times
/// @throws std::runtime_error if two different torques, or two images of a torque, have one stamp
Pairs pairByStamp(const std::vector<BagImage>& images, std::vector<BagTorque> torques);

/// Takes images dt apart, to a quarter of dt, and with each the torque that is in force when the next one is due.
/// A torque is in force until there is another, as controllers hold it. A new segment begins where an image is
/// missing.
/// @param images  by their times
/// @param dt      [s], > 0
/// @throws std::runtime_error if images do not come at a multiple of dt
Pairs pairInTime(const std::vector<BagImage>& images, std::vector<BagTorque> torques, double dt);

/// Decides which times count, and pairs images and torques: by their stamps where dt is 0, else in time. Then stamps
/// count where images and torques have stamps that can be trusted, else the times of recording, which know only
/// one clock.
/// @param images, torques  in the order of the file
/// @return                 at least one frame
/// @throws std::runtime_error also if there is no frame
Pairs pairUp(std::vector<BagImage> images, std::vector<BagTorque> torques, double dt);

}  // namespace ddm
