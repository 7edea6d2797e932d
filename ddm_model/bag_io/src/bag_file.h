// A bag on disk: its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/message_bytes.h>
#include <ros/message_traits.h>
#include <ros/time.h>

#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

#include "refuse.h"

namespace ddm {

/// A topic of a bag.
struct BagConnection {
  std::string topic;
  std::string type;
  std::string md5sum;     ///< of the definition of the message
  std::string publisher;  ///< name of its node; empty: not known
};

struct BagMessage {
  const BagConnection& connection;
  ros::Time recorded;      ///< when it arrived
  std::string_view bytes;  ///< valid while the message is handled
};

/// Reads bags of format 2.0. Not by rosbag::View, which follows positions and sizes of a damaged bag beyond
/// its memory and then ends the process: each of them is compared here with the bytes that are there. As in
/// rosbag, only chunks that the index names count, since older versions of `rosbag reindex` leave other bytes.
///
/// All functions throw std::runtime_error with the fault and the remedy.
class BagFile {
 public:
  /// Reads the index.
  /// @param in  owned by the caller; binary, can be positioned
  explicit BagFile(std::istream* in);

  /// By their numbers in the file.
  const std::map<std::uint32_t, BagConnection>& connections() const { return connections_; }

  /// Calls `take` with each message of these topics, in the order of the file. Chunks that hold none of them
  /// are neither read nor decompressed.
  void forEachMessage(const std::set<std::string>& topics,
                      const std::function<void(const BagMessage&)>& take);

 private:
  std::string read(std::uint64_t begin, std::uint64_t end);

  std::istream* in_;
  std::uint64_t index_ = 0;                                  // its position, after the last chunk
  std::map<std::uint64_t, std::set<std::uint32_t>> chunks_;  // by position: connections in each
  std::map<std::uint32_t, BagConnection> connections_;
};

/// @throws std::runtime_error with the topic, the time and the fault
[[noreturn]] void refuseMessage(const BagMessage& message, const std::exception& fault);

/// A message as the type that its topic has.
/// @throws std::runtime_error with the topic, the time and the fault
template <class Message>
Message parse(const BagMessage& message) {
  const BagConnection& connection = message.connection;
  if (connection.md5sum != ros::message_traits::md5sum<Message>()) {
    refuse("topic ", connection.topic, " was recorded with another definition of ", connection.type,
           ": convert the bag with `rosbag fix`, or record it again");
  }
  try {
    return messageFromBytes<Message>(message.bytes.data(), message.bytes.size());
  } catch (const std::exception& e) {
    refuseMessage(message, e);
  }
}

}  // namespace ddm
