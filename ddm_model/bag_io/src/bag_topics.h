// Which topics of a bag are meant, what their messages say, and who published them.
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

/// A topic of a bag; an empty name: there is none.
struct Topic {
  std::string name;
  std::string type;
};

/// The topics of a bag that are read.
struct BagTopics {
  Topic images, torques;
  Topic goal;  ///< may be missing
};

/// "/torque" of "torque".
std::string absolute(const std::string& topic);

/// The topics that the options mean: of the same name, else in some namespace; of images also the compressed form.
/// @throws std::runtime_error naming key and remedy: no such topic, several, another type, a transport that cannot be
///         read, one topic with two meanings, torques without stamps of images where there is no dt
BagTopics findTopics(const BagFile& bag, const BagOptions& options);

/// Whether images on the topic are sensor_msgs/Image, not CompressedImage.
bool isRaw(const BagConnection& connection);

/// Reads the torques of one bag.
class TorqueReader {
 public:
  /// The types that are read.
  static std::vector<std::string> types();
  /// Whether its messages carry the stamp of the image that they answer.
  static bool answersImages(const std::string& type) { return type == "ddm_msgs/Torque"; }

  /// @param motors  see BagOptions
  explicit TorqueReader(std::vector<std::string> motors) : motors_(std::move(motors)) {}

  /// @return nothing for a message about other joints or without their effort, and where no torque
  ///         acted
  /// @throws std::runtime_error with the time, the fault and the remedy: a torque that is not
  ///         finite, another number of motors than before, motors that are not in the message
  std::optional<BagTorque> read(const BagMessage& message);

  /// Which messages of which publishers have no effort of the motors: "12 messages of /driver"; empty: none.
  std::string withoutEffort() const;

 private:
  std::vector<std::string> motors_;
  std::vector<std::string> names_;                     // of the joints of the first message
  std::size_t dim_ = 0;                                // 0: no torque yet
  std::map<std::string, std::size_t> without_effort_;  // messages by publisher
};

/// Who published on a topic, and when.
class Publishers {
 public:
  void add(const std::string& name, const ros::Time& time);
  bool empty() const { return spans_.empty(); }

  /// A publisher without a name is not known to be another one: rosbag leaves it out in some latched messages.
  /// @param remedy  for two at the same time
  /// @return        a note if there are several, one after the other; else empty
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
