// A bag as it lies on disk: its topics and messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <string>

namespace ddm {

/// A topic of a bag.
struct BagConnection {
  std::string topic;
  std::string type;
  std::string md5sum;  ///< of the definition of the message
};

/// Reads bags of format 2.0 from front to back. rosbag follows positions and sizes in the file
/// wherever they lead, be it out of its memory; here each size is compared with what is there
/// before memory is taken, and what no message needs (the index) is stepped over.
///
/// All functions throw std::runtime_error with the fault and the remedy.
class BagFile {
 public:
  using TakeMessage = std::function<void(const BagConnection&, const std::string& message)>;

  /// Reads what connections there are.
  /// @param in  stays with the caller; binary, can be positioned
  explicit BagFile(std::istream* in);

  /// By their numbers in the file.
  const std::map<std::uint32_t, BagConnection>& connections() const { return connections_; }

  /// Calls `take` with each message, in the order of the file.
  void forEachMessage(const TakeMessage& take);

 private:
  std::istream* in_;
  std::uint64_t size_;   // of the file
  std::uint64_t first_;  // position of the first chunk
  std::uint64_t index_;  // position after the last chunk
  std::uint32_t num_chunks_;
  std::map<std::uint32_t, BagConnection> connections_;
};

}  // namespace ddm
