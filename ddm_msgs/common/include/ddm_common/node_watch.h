// Detects that the process of another node has ended.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

namespace ddm {

/// Keeps a connection to the process of a node. The connection breaks as soon as the process ends.
///
/// Neither roscpp nor the ROS master detects a kill -9: roscpp tries to reconnect, and
/// ros::Subscriber::getNumPublishers() still counts the connection. NodeWatch does not detect a
/// stopped process or an unplugged cable; use time limits for these cases.
class NodeWatch {
 public:
  NodeWatch();
  ~NodeWatch();
  NodeWatch(const NodeWatch&) = delete;
  NodeWatch& operator=(const NodeWatch&) = delete;

  /// Call this function when a message from a node arrives: the node is alive. The first call for a
  /// node makes a thread look up its address. Returns at once.
  /// @param node  resolved name of the node
  void hear(const std::string& node);

  /// Whether the process of the node in the last call of hear() has ended since that call.
  bool died() const;

 private:
  struct State;

  static void watch(const std::shared_ptr<State>& state);

  std::shared_ptr<State> state_;  // shared with the thread, which may outlive this object
};

}  // namespace ddm
