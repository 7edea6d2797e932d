// Bags of the toy world, for tests.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/bag_reader.h>
#include <ddm_common/image_codec.h>
#include <ddm_msgs/Torque.h>
#include <ddm_msgs/testing/expect_error.h>
#include <ddm_msgs/testing/temp_folder.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Image.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "toy_data.h"

namespace ddm {
namespace testing {

inline sensor_msgs::Image imageMessage(double stamp, const Image& grey, int size = kToySize) {
  return encodeImage(grey, size, ros::Time(stamp), "camera");
}

inline ddm_msgs::Torque torqueMessage(double stamp, const std::vector<double>& torque) {
  ddm_msgs::Torque message;
  message.header.stamp = ros::Time(stamp);
  message.torque = torque;
  return message;
}

/// Writes single messages to a bag; closed when it goes.
class ToyBag {
 public:
  explicit ToyBag(const std::string& path, const BagOptions& topics = BagOptions())
      : topics_(topics), bag_(path, rosbag::bagmode::Write) {
    bag_.setCompression(rosbag::compression::LZ4);
  }

  template <class Message>
  void write(const std::string& topic, double time, const Message& message) {
    bag_.write(topic, ros::Time(time), message);
  }
  void image(double stamp, double angle) { image(stamp, imageMessage(stamp, toyImage(angle))); }
  void image(double time, const sensor_msgs::Image& image) {
    write(topics_.image_topic, time, image);
  }
  void torque(double stamp, const std::vector<double>& torque) {
    write(topics_.torque_topic, stamp, torqueMessage(stamp, torque));
  }
  void goal(double time, const sensor_msgs::Image& image) {
    write(topics_.goal_topic, time, image);
  }

  /// Image and torque of one stamp; the torque is recorded a moment later, as from a node.
  void frame(double stamp, double angle, double u) {
    image(stamp, angle);
    write(topics_.torque_topic, stamp + 0.01, torqueMessage(stamp, {u}));
  }

 private:
  BagOptions topics_;
  rosbag::Bag bag_;
};

/// A whole trial at 0.2 s between frames, from 10 s on.
inline void writeTrial(const std::string& path, const DataSet& trial, bool with_goal = true,
                       const BagOptions& topics = BagOptions()) {
  ToyBag bag(path, topics);
  const int size = trial.imageSize();
  if (with_goal) bag.goal(10.0, imageMessage(10.0, toyImage(3.0, size), size));
  for (Eigen::Index t = 0; t < trial.numFrames(); ++t) {
    const double stamp = 10.0 + 0.2 * static_cast<double>(t);
    bag.image(stamp, imageMessage(stamp, trial.image(t), size));
    bag.torque(stamp, {trial.torques()(0, t)});
  }
}

/// A bag that a test writes and reads.
class BagTest : public ::testing::Test {
 protected:
  BagContent read() const { return readBag(path_, kToySize, options_); }
  std::vector<Eigen::Index> segmentSizes() const {
    const DataSet data = read().data;
    std::vector<Eigen::Index> sizes;
    for (const Segment& segment : data.segments()) sizes.push_back(segment.size);
    return sizes;
  }
  /// Whether there are as many notes as texts are given, and each has all of its parts.
  ::testing::AssertionResult notes(const std::vector<std::vector<std::string>>& texts) const {
    const std::vector<std::string> notes = read().notes;
    if (notes.size() != texts.size()) {
      return ::testing::AssertionFailure() << ::testing::PrintToString(notes);
    }
    ::testing::AssertionResult all = ::testing::AssertionSuccess();
    for (std::size_t i = 0; i < texts.size() && all; ++i) all = names(notes[i], texts[i]);
    return all;
  }
  /// Whether the error names the bag and all the parts.
  ::testing::AssertionResult isRefused(std::vector<std::string> parts = {}) const {
    parts.push_back("bag " + path_);
    return throwsNaming<std::runtime_error>([this] { read(); }, parts);
  }

  BagOptions options_;
  const TempFolder folder_;
  const std::string path_ = folder_.file("trial.bag");
};

}  // namespace testing
}  // namespace ddm
