// Reads bags: images and torques on the wire to a data set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>

#include <istream>
#include <string>
#include <vector>

namespace ddm {

/// Block `data_set`.
struct BagOptions {
  std::string image_topic = "camera/image_raw";  ///< sensor_msgs/Image
  std::string torque_topic = "torque";           ///< ddm_msgs/Torque
  std::string goal_topic = "goal_image";         ///< sensor_msgs/Image, may be missing in the bag

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("image_topic", image_topic);
    visitor("torque_topic", torque_topic);
    visitor("goal_topic", goal_topic);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// A bag and what was found in it.
struct BagContent {
  DataSet data;                 ///< frames: images with their torques
  std::string camera;           ///< size and encoding of the images, "51x51 mono8"
  std::vector<double> times{};  ///< of each frame, since the first one [s]
  double interval = 0.0;        ///< median of those between frames [s]; 0 if there is only one
  int num_images_without_torque = 0;
  int num_torques_without_image = 0;
};

/// Reads one bag: ours, or one made with plain `rosbag record`.
///
/// An image and a torque are a frame if their header stamps are equal. A new piece begins after an
/// image without a torque, and after a gap of more than 1.5 times the median interval. A topic is
/// found under its name or under any namespace. The goal image is the last on its topic.
/// @param image_size  images are converted to image_size x image_size grey values
/// @throws std::runtime_error naming the bag, the fault and the remedy: unreadable, cut short,
///         still active, without a topic, a topic of another type, images that change size or
///         encoding, torques that are not finite or change dimension, no image with a torque
BagContent readBag(const std::string& path, int image_size, const BagOptions& options);

/// The same from any stream; messages do not name it.
/// @param in  binary, can be positioned
BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options);

}  // namespace ddm
