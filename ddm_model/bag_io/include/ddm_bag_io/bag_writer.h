// Writes the bag of one trial, so that what is under the final name is always complete.
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

/// Writes images, torques and the goal image of one trial. The bag is PATH.active until close().
/// Chunks are LZ4 (raw chunks have no checksum) and small, so that little is lost with a killed
/// recorder.
class BagWriter {
 public:
  /// A PATH.active that is there already is not replaced: it may be all that is left of a trial,
  /// and `rosbag reindex` can recover it.
  /// @throws std::runtime_error with the path and the reason
  BagWriter(const std::string& path, const BagOptions& options);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Each is written at its header stamp. @throws std::runtime_error with the path and the reason
  void write(const sensor_msgs::Image& image);
  void write(const ddm_msgs::Torque& torque);
  void writeGoal(const sensor_msgs::Image& goal, const ros::Time& stamp);

  /// Their stamps.
  const std::set<ros::Time>& images() const { return images_; }
  const std::set<ros::Time>& torques() const { return torques_; }
  /// Number of images whose torque is there too.
  int numFrames() const;

  /// Closes the bag and gives it its final name. From then on it survives a power cut.
  /// @throws std::runtime_error with the path and the reason
  void close();

 private:
  template <class Message>
  void writeAt(const std::string& topic, const ros::Time& stamp, const Message& message);
  void abandon();

  std::string path_;
  BagOptions options_;
  std::unique_ptr<rosbag::Bag> bag_;  // null where it was abandoned
  std::set<ros::Time> images_;
  std::set<ros::Time> torques_;
};

}  // namespace ddm
