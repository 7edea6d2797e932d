// A bag on disk, with its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/message_bytes.h>
#include <ros/message_traits.h>
#include <ros/time.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bag_texts.h"

namespace ddm {

/// A topic of a bag, with one of its publishers.
struct BagConnection {
  std::string topic;
  std::string type;
  std::string md5sum;     ///< checksum of the message definition
  std::string publisher;  ///< name of the node; empty: unknown
};

struct BagMessage {
  const BagConnection& connection;
  ros::Time recorded;      ///< time of recording
  std::string_view bytes;  ///< valid only during the callback
};

/// Reads bags of format 2.0. rosbag::View is not used, because it follows positions and sizes in a
/// damaged bag beyond its memory and ends the process. This class compares each of them with the
/// size of the file. Like rosbag, it reads only chunks that the index lists, since older versions
/// of `rosbag reindex` leave other bytes in the file.
///
/// All functions throw std::runtime_error with the fault and the remedy.
class BagFile {
 public:
  /// Opens a bag and reads its index.
  explicit BagFile(const std::string& path);

  /// @return all connections, by their numbers in the file
  const std::map<std::uint32_t, BagConnection>& connections() const { return connections_; }

  /// @return number of bytes behind the index, which belong to nothing in the index
  std::uint64_t bytesBehindIndex() const { return bytes_behind_index_; }

  /// Calls `take` with each message of these topics, in the order of the file. Skips chunks without
  /// these topics.
  void forEachMessage(const std::set<std::string>& topics,
                      const std::function<void(const BagMessage&)>& take);

 private:
  std::string read(std::uint64_t begin, std::uint64_t end);

  std::ifstream in_;
  std::uint64_t index_ = 0;  // position of the index, after the last chunk
  std::uint64_t bytes_behind_index_ = 0;
  // Connections in each chunk, by position of the chunk.
  std::map<std::uint64_t, std::set<std::uint32_t>> chunks_;
  std::map<std::uint32_t, BagConnection> connections_;
};

/// @throws std::runtime_error with the topic, the time and the fault
[[noreturn]] void refuseMessage(const BagMessage& message, const std::exception& fault);

/// Parses a message as the given type, which must be that of its topic.
/// @throws std::runtime_error with the topic, the time and the fault
template <class Message>
Message parse(const BagMessage& message) {
  const BagConnection& connection = message.connection;
  if (connection.md5sum != ros::message_traits::md5sum<Message>()) {
    refuseBag("topic ", connection.topic, " was recorded with another definition of ",
              connection.type, ": convert the bag with `rosbag fix`, or record it again");
  }
  try {
    return messageFromBytes<Message>(message.bytes.data(), message.bytes.size());
  } catch (const std::exception& e) {
    refuseMessage(message, e);
  }
}

}  // namespace ddm
