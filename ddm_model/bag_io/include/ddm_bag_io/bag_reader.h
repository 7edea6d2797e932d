// Reads bags: images and torques on the wire to a data set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/data_set.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <istream>
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
  std::string goal_topic = "goal_image";         ///< as images, may be missing in the bag
  double dt = 0.0;  ///< time between frames, for bags without ddm_msgs/Torque [s]
  /// Joints of a sensor_msgs/JointState, or parts ("torque.z") of a geometry_msgs/WrenchStamped;
  /// empty: all joints, in the message's order.
  std::vector<std::string> motors{};
  std::vector<int> crop{0, 0, 0, 0};  ///< of images: column, row, width, height; 0: to the edge

  /// Whether some of the bags were recorded otherwise than this project does. Then their cameras
  /// may differ: it is for who says so to see that the images look alike.
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
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// An image of a bag, or a picture that goes with bags, as training sees it: cropped and converted,
/// but one of image_size is not cropped.
/// @throws std::invalid_argument see decodeImage()
Grey greyOf(const sensor_msgs::Image& image, int image_size, const BagOptions& options);

/// A bag and what was found in it.
struct BagContent {
  DataSet data;                 ///< frames: images with their torques
  std::string camera;           ///< size and encoding of the images, "51x51 mono8"
  std::vector<double> times{};  ///< of each frame, since the first one [s]
  /// A number for each frame; frames with the same time, image and torque have the same number.
  /// Bags that DDM recorded have none, because each run of a simulator may begin at the same time.
  std::vector<std::size_t> frame_ids{};
  double interval = 0.0;  ///< median of those between frames [s]; 0 if there is only one
  std::vector<double> images_without_torque{};  ///< their times, since the first frame [s]
  std::vector<double> torques_without_image{};  ///< likewise
  /// What a user should know: what does not count and why, clocks that cannot be trusted, and so on.
  std::vector<std::string> notes{};
};

/// Reads one bag: ours, or one made with plain `rosbag record`.
///
/// Torques are ddm_msgs/Torque: an image and a torque are a frame if their header stamps are equal,
/// and a new segment begins after an image without a torque, and after a gap of more than 1.5 times
/// the median interval. Or they are std_msgs/Float64 or Float32, arrays of them, the effort of a
/// sensor_msgs/JointState, or parts of a geometry_msgs/WrenchStamped: then images are taken dt
/// apart, each with the torque in force until the next, and a torque is in force until there is
/// another. Stamps count where images and torques have them and they can be trusted, else the times
/// at which messages were recorded.
///
/// A topic is found under its name or under any namespace, that of images also with /compressed
/// behind it. The goal image is the last on its topic. An image that cannot be decoded leaves a gap.
/// Memory is that of the frames and of the largest chunk; chunks without these topics are skipped.
/// @param image_size  images are cropped and converted to image_size x image_size grey values; one
///                    of that size is not cropped
/// @throws std::runtime_error naming the bag, the fault and the remedy: unreadable, cut short,
///         still active, without a topic, a topic of another type, images that change size or
///         encoding, more broken images than whole ones, torques that are not finite or change
///         dimension, no image with a torque, images farther apart than dt, torques of two nodes at
///         the same time
BagContent readBag(const std::string& path, int image_size, const BagOptions& options);

/// The same from any stream; messages do not name it.
/// @param in  binary, can be positioned
BagContent readBagBytes(std::istream* in, int image_size, const BagOptions& options);

/// Compares each bag with those before it: the same file by two paths, copies, and parts of a recording that overlap.
class DifferentBags {
 public:
  /// @throws std::runtime_error if the file, or more than a tenth of the frames, were there before
  void require(const std::string& path, const BagContent& content);

 private:
  std::map<std::pair<std::uintmax_t, std::uintmax_t>, std::string>
      files_;                                            // path of each device and inode
  std::unordered_map<std::size_t, std::string> frames_;  // bag of each frame
};

}  // namespace ddm
