// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/image_codec.h>
#include <ddm_model/data_set.h>
#include <ros/time.h>
#include <sensor_msgs/Image.h>

#include <map>
#include <string>
#include <vector>

#include "ddm_bag_io/bag_reader.h"
#include "pairing.h"

namespace ddm {

/// Takes messages in the order of the file, in two rounds: only images that become frames are
/// decoded. All functions throw std::runtime_error with stamp, fault and remedy.
class TrialMessages {
 public:
  /// @param image_size  images are converted to image_size x image_size grey values
  TrialMessages(int image_size, const BagOptions& options)
      : image_size_(image_size), options_(options) {}

  /// First round.
  /// @param content  the same number for images with the same bytes
  void takeImageTime(const ros::Time& stamp, const ros::Time& recorded, std::size_t content);
  void takeTorque(TimedTorque torque) { torques_.push_back(std::move(torque)); }
  /// Ends it. dt: see BagOptions [s]; 0: what belongs together has the same stamp.
  void pair(double dt);

  /// Second round. Whether an image becomes a frame.
  /// @param number  of takeImageTime(), from 0
  bool wants(std::size_t number) const { return frame_of_.count(number) > 0; }
  /// @param encoding  as the camera sent it, for messages
  void takeImage(std::size_t number, const sensor_msgs::Image& image, const std::string& encoding);
  /// An image that cannot be decoded leaves a gap.
  void takeBrokenImage(std::size_t number, const std::string& fault);
  void takeGoal(const sensor_msgs::Image& image);
  /// @throws std::runtime_error also if more images are broken than whole
  BagContent frames() const;

  /// What a user should know about the bag; all of them are in BagContent.
  void note(const std::string& text) { notes_.push_back(text); }

 private:
  struct Image {
    ros::Time stamp;
    ros::Time recorded;
    std::size_t content;
  };

  std::vector<std::size_t> imagesInOrder(double dt) const;
  std::string clockFault(const std::vector<std::size_t>& order, bool by_stamp) const;
  std::string torqueClockFault() const;
  void pairByClocks(double dt, const std::vector<std::size_t>& order);
  void noteGaps();

  int image_size_;
  BagOptions options_;
  std::vector<Image> all_images_;
  std::vector<TimedTorque> torques_;  // all
  bool of_others_ = false;            // not recorded by this project
  double lag_ = 0.0;                  // of the torques' clock behind that of the images [s]
  Pairs pairs_;
  std::map<std::size_t, std::size_t> frame_of_;  // by the number of the image
  std::vector<Grey> greys_;                      // of the frames; empty until they come
  std::size_t num_broken_ = 0;
  std::string first_broken_;
  Grey goal_;
  std::string camera_;
  std::vector<std::string> notes_;
};

}  // namespace ddm
