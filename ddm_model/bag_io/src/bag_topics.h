// Topics of a bag: selects them, reads their torques and checks their publishers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bag_file.h"
#include "ddm_bag_io/bag_reader.h"
#include "pairing.h"

namespace ddm {

/// A topic of a bag. An empty name means that there is none.
struct Topic {
  std::string name;
  std::string type;
};

/// The topics that the reader uses.
struct BagTopics {
  Topic images, torques;
  Topic goal;  ///< may be missing
};

/// @return "/torque" for "torque"
std::string absolute(const std::string& topic);

/// Finds the topics that the options name: exactly, or else in some namespace. An image topic may
/// also be a compressed form.
/// @throws std::runtime_error that names the key and the remedy. Faults: there is no such topic, or
///         several; the type or the image transport cannot be read; a topic has two roles; torques
///         do not name their images, and dt is 0
BagTopics findTopics(const BagFile& bag, const BagOptions& options);

/// Whether images on the topic are sensor_msgs/Image, not CompressedImage.
bool isRaw(const BagConnection& connection);

/// Reads the torques of one bag.
class TorqueReader {
 public:
  /// @return message types that read() supports
  static std::vector<std::string> types();
  /// @return whether messages of this type have the stamp of the image that they answer
  static bool answersImages(const std::string& type) { return type == "ddm_msgs/Torque"; }

  /// @param motors  see BagOptions
  explicit TorqueReader(std::vector<std::string> motors) : motors_(std::move(motors)) {}

  /// @return the torque; empty for a message about other joints, without efforts, or about a time
  ///         in which no single torque acted
  /// @throws std::runtime_error with the time, the fault and the remedy. Faults: a torque is not
  ///         finite; the number of motors changes; motors are not in the message
  std::optional<BagTorque> read(const BagMessage& message);

  /// @return publishers of messages without efforts, as "12 messages of /driver"; empty: none
  std::string withoutEffort() const;

 private:
  std::vector<std::string> motors_;
  std::vector<std::string> names_;                     // joints of the first message
  std::size_t dim_ = 0;                                // number of motors; 0: no torque yet
  std::map<std::string, std::size_t> without_effort_;  // number of messages, by publisher
};

/// Publishers of a topic, and the times at which they published.
class Publishers {
 public:
  void add(const std::string& name, const ros::Time& time);
  bool empty() const { return spans_.empty(); }

  /// Checks that no two publishers published at the same time. Ignores publishers without a name,
  /// which rosbag omits in some latched messages.
  /// @param what    beginning of the message, before the publishers
  /// @param remedy  remedy for two publishers at the same time
  /// @return        note to the user if several published, one after the other; otherwise empty
  /// @throws std::runtime_error if two published at the same time
  std::string requireOneAtATime(const std::string& what, const std::string& remedy) const;

 private:
  struct Span {
    ros::Time first, last;
    std::size_t number = 0;
  };
  std::map<std::string, Span> spans_;
};

}  // namespace ddm
