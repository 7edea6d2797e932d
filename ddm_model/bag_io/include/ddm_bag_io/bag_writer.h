// Writes the bag of one trial. A bag under its final name is always complete.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/Torque.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Image.h>

#include <memory>
#include <set>
#include <string>

#include "ddm_bag_io/bag_reader.h"

namespace ddm {

/// Closes a bag. If that fails, as on a full disk, the bag leaks on purpose, since its destructor
/// would throw and end the process.
struct CloseBag {
  void operator()(rosbag::Bag* bag) const;
};

/// Writes images, torques and the goal image of one trial to PATH.active, which close() renames to
/// PATH. Without close(), PATH.active stays. Chunks are LZ4, since uncompressed chunks have no
/// checksum, and small, so that a recorder that is killed loses little.
class BagWriter {
 public:
  /// Creates PATH.active. An existing PATH.active is an error, since it may be all that is left of
  /// a trial; `rosbag reindex` can recover it.
  /// @throws std::runtime_error with the path and the reason
  BagWriter(const std::string& path, const BagOptions& options);

  /// Each function writes a message at its header stamp (the goal image at `stamp`).
  /// @throws std::runtime_error with the path and the reason
  void write(const sensor_msgs::Image& image);
  void write(const ddm_msgs::Torque& torque);
  void writeGoal(const sensor_msgs::Image& goal, const ros::Time& stamp);

  /// @return stamps of the images or torques written so far
  const std::set<ros::Time>& images() const { return images_; }
  const std::set<ros::Time>& torques() const { return torques_; }
  /// @return number of images whose torque is written, too
  int numFrames() const;

  /// Closes the bag and renames it to its final name. The bag then survives a power failure.
  /// @throws std::runtime_error with the path and the reason
  void close();

 private:
  template <class Message>
  void writeAt(const std::string& topic, const ros::Time& stamp, const Message& message);

  std::string path_;
  BagOptions options_;
  std::unique_ptr<rosbag::Bag, CloseBag> bag_;
  std::set<ros::Time> images_;
  std::set<ros::Time> torques_;
};

}  // namespace ddm
