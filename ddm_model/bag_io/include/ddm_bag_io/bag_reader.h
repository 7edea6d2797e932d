// Reads the images and torques of a bag as a data set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace ddm {

/// Block `data_set`.
struct BagOptions {
  std::string image_topic = "camera/image_raw";  ///< sensor_msgs/Image or CompressedImage
  std::string torque_topic = "torque";           ///< see readBag()
  std::string goal_topic = "goal_image";         ///< like image_topic; may be missing in the bag
  double dt = 0.0;  ///< sampling time, for bags without ddm_msgs/Torque [s]
  /// Motors: joints of a sensor_msgs/JointState, or parts ("torque.z") of a
  /// geometry_msgs/WrenchStamped. Empty: all joints, in the order of the message.
  std::vector<std::string> motors{};
  /// Part of the images: column, row, width, height [pixels]. Width or height 0: to the edge.
  std::vector<int> crop{0, 0, 0, 0};

  /// @return whether the options fit bags that another program recorded. The cameras of such bags
  ///         may differ, and the user has to ensure that their images look alike
  bool ofOthers() const { return dt > 0.0 || crop != std::vector<int>{0, 0, 0, 0}; }

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("image_topic", image_topic);
    visitor("torque_topic", torque_topic);
    visitor("goal_topic", goal_topic);
    visitor("dt", dt);
    visitor("motors", motors);
    visitor("crop", crop);
  }
  /// @return all faults of these values, in words for the user; empty if the values are valid
  std::vector<std::string> problems() const;
};

/// Converts an image as training does: crops it, unless its size is image_size, and resizes it.
/// @param image_size  width and height of the result [pixels]
/// @return            [image_size^2]
/// @throws std::invalid_argument see decodeImage()
Image greyOf(const sensor_msgs::Image& image, int image_size, const BagOptions& options);

/// Content of a bag.
struct BagContent {
  DataSet data;                 ///< samples, and the goal image if there is one
  std::string camera;           ///< size and encoding of the images, such as "51x51 mono8"
  std::vector<double> times{};  ///< time of each sample since the first one [s]
  /// Hash of time and content of each image, also of those that are in no sample. With
  /// ddm_msgs/Torque: of time, image and torque of each sample. Empty for bags that DDM recorded,
  /// because episodes of a simulator may begin at the same time and be equal.
  std::vector<std::size_t> ids{};
  double interval = 0.0;  ///< median time between samples [s]; 0 if there is only one
  std::vector<double> images_without_torque{};  ///< times since the first sample [s]
  std::vector<double> torques_without_image{};  ///< times since the first sample [s]
  /// Messages to the user: data that were dropped and why, unreliable clocks, and so on.
  std::vector<std::string> notes{};
};

/// Reads one bag, recorded by trial_recorder or by plain `rosbag record`.
///
/// If torques are ddm_msgs/Torque, an image and a torque with equal header stamps are a sample. A
/// new segment begins after an image without a torque, and after a gap of more than 1.5 times the
/// median interval.
///
/// Torques may also be std_msgs/Float64 or Float32, arrays of them, the effort of a
/// sensor_msgs/JointState, or parts of a geometry_msgs/WrenchStamped. Images are then taken dt
/// apart, each with the torque that is in force when the next image is due. A torque is in force
/// until the next torque. Times are header stamps if images and torques have reliable ones,
/// otherwise times of recording.
///
/// A topic is found by its name or in any namespace; image topics are also found with /compressed
/// at their end. The last message on its topic is the goal image. An image that cannot be decoded
/// leaves a gap. Memory is that of the samples and of the largest chunk. Chunks without these
/// topics are skipped.
/// @param image_size  width and height of the images in the data set [pixels]; images of another
///                    size are cropped and resized
/// @throws std::runtime_error that names the bag, the fault and the remedy. Faults: the bag is
///         unreadable, truncated, or still *.active; a topic is missing or has another type; images
///         change size or encoding; more images are broken than whole; torques are not finite or
///         change dimension; no image has a torque; images are farther apart than dt, or so close
///         together that only one is taken; two nodes publish torques or images at the same time;
///         the clock of the recording was set back to a time that it had before
BagContent readBag(const std::string& path, int image_size, const BagOptions& options);

/// Detects bags that share images: one file under two paths, copies, or overlapping recordings.
class DifferentBags {
 public:
  /// Compares a bag with all bags of earlier calls.
  /// @throws std::runtime_error if the file occurred before, or if the bag shares more than a tenth
  ///         of the images of the smaller bag with another
  void require(const std::string& path, const BagContent& content);

 private:
  // Path, by device and inode.
  std::map<std::pair<std::uintmax_t, std::uintmax_t>, std::string> files_;
  // Path of the bag, by BagContent::ids.
  std::unordered_map<std::size_t, std::string> images_;
  std::map<std::string, std::size_t> num_images_;  // of each bag, by path
};

}  // namespace ddm
