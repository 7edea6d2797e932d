// Pairs images with the torques that acted after them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ddm {

/// @return time difference, may be negative [s]. Subtracting ros::Time throws if it exceeds 68
///         years
inline double secondsBetween(const ros::Time& from, const ros::Time& to) {
  const std::int64_t seconds = std::int64_t{to.sec} - from.sec - (to.nsec < from.nsec ? 1 : 0);
  const std::int64_t rest =
      std::int64_t{to.nsec} - from.nsec + (to.nsec < from.nsec ? 1000000000 : 0);
  return static_cast<double>(seconds) + 1e-9 * static_cast<double>(rest);
}

/// @return median of the values. Of two middle values it is the lower one, since gaps only lengthen
///         intervals. Used for clocks because single messages may be late
/// @param values  at least one
double median(std::vector<double> values);

/// @return median time between successive times [s]; 0 if there are fewer than two
double medianInterval(const std::vector<ros::Time>& times);

/// An image of a bag, before its pixels are decoded.
struct BagImage {
  ros::Time stamp;      ///< header stamp; 0: there is none
  ros::Time recorded;   ///< time of recording
  std::size_t number;   ///< index in the order of the file
  std::size_t content;  ///< hash of the message without its header
  ros::Time time{};     ///< set by pairUp(): time for the order and for gaps
  ros::Time act{};      ///< set by pairUp(): time by the clock of the torques
};

/// A torque of a bag.
struct BagTorque {
  ros::Time stamp;             ///< header stamp; 0: there is none
  ros::Time recorded;          ///< time of recording
  std::vector<double> torque;  ///< of each motor [N m]
  ros::Time time{};            ///< set by pairUp(): stamp or recorded
};

/// The samples of a bag, and the images and torques without a partner.
struct Pairs {
  /// A sample: an image, and the torque that acted until the next image.
  struct Frame {
    std::size_t image;           ///< BagImage::number
    ros::Time time;              ///< BagImage::time
    std::vector<double> torque;  ///< [N m]
    bool new_segment;            ///< whether the previous sample is not its predecessor
  };
  std::vector<Frame> frames{};  ///< in order of time
  std::vector<ros::Time> images_without_torque{};
  std::vector<ros::Time> torques_without_image{};
  double lag = 0.0;                  ///< clock of the torques minus clock of the images [s]
  bool of_others = false;            ///< whether another program recorded the bag
  std::vector<std::size_t> ids{};    ///< see BagContent
  std::vector<std::string> notes{};  ///< messages to the user

  std::vector<ros::Time> times() const;
};

/// Pairs images and torques with equal stamps, as trial_recorder records them. A new segment begins
/// after an image without a torque, and after a gap of more than 1.5 times the median interval.
/// @param images  in order of time
/// @throws std::runtime_error if two different torques, or two images of a torque, have one stamp
Pairs pairByStamp(const std::vector<BagImage>& images, std::vector<BagTorque> torques);

/// Takes images dt apart, with a tolerance of dt/4, each with the torque that is in force when the
/// next image is due. Controllers hold a torque, so that it is in force until the next torque. A
/// new segment begins if an image is missing. If images are about dt apart, all of them are taken,
/// and a new segment begins after a gap of more than 1.5 dt.
/// @param images  in order of time
/// @param dt      sampling time, > 0 [s]
/// @throws std::runtime_error if dt is not about a multiple of the time between images, or if only
///         one of several images is taken
Pairs pairInTime(const std::vector<BagImage>& images, std::vector<BagTorque> torques, double dt);

/// Chooses the times that count, and pairs images and torques: by equal stamps if dt is 0,
/// otherwise in time. In the latter case times are stamps if images and torques have reliable ones,
/// and otherwise times of recording, which all come from one clock.
/// @param images, torques  in the order of the file
/// @param dt               sampling time [s]
/// @return                 at least one sample
/// @throws std::runtime_error like the functions above, if there is no sample, and if the clock of
///         the recording was set back to a time that it had before
Pairs pairUp(std::vector<BagImage> images, std::vector<BagTorque> torques, double dt);

}  // namespace ddm
