// A bag as it lies on disk: its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <set>
#include <string>

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
  ros::Time recorded;  ///< when it arrived
  std::string bytes;
};

/// Reads bags of format 2.0. As rosbag does, it goes from the index to the chunks, so that bytes
/// which no index names (older versions of `rosbag reindex` leave some) do not count. Unlike rosbag,
/// which follows positions and sizes beyond its memory and then ends the process, it compares each of
/// them with what is there before it takes memory.
///
/// All functions throw std::runtime_error with the fault, its position and the remedy.
class BagFile {
 public:
  using TakeMessage = std::function<void(const BagMessage&)>;
  using Numbers = std::set<std::uint32_t>;  ///< of connections

  /// Reads what connections there are.
  /// @param in  stays with the caller; binary, can be positioned
  explicit BagFile(std::istream* in);

  /// By their numbers in the file.
  const std::map<std::uint32_t, BagConnection>& connections() const { return connections_; }

  /// That no record of the index names.
  std::uint64_t bytesAfterIndex() const { return after_index_; }

  /// Calls `take` with each message of these topics, in the order of the file. Chunks without any
  /// are not decompressed.
  void forEachMessage(const std::set<std::string>& topics, const TakeMessage& take);

 private:
  void readIndex(std::size_t num_connections, std::size_t num_chunks);
  void forEachMessageInChunk(std::uint64_t position, const Numbers& listed, const Numbers& wanted,
                             const TakeMessage& take) const;
  void forEachMessageIn(std::istream* chunk, std::uint64_t begin, std::uint64_t end,
                        const Numbers& wanted, const TakeMessage& take) const;

  std::istream* in_;
  std::uint64_t size_;                       // of the file
  std::uint64_t first_;                      // position where chunks may begin
  std::uint64_t after_index_ = 0;            // bytes
  std::uint64_t index_;                      // position of the index, after the last chunk
  std::map<std::uint64_t, Numbers> chunks_;  // by their positions: what the index says is in them
  std::map<std::uint32_t, BagConnection> connections_;
};

}  // namespace ddm
