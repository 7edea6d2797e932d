// Notices that another node has died.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

namespace ddm {

/// Keeps a connection to the process of a node, which breaks as soon as the process ends.
///
/// Neither ROS nor its master notices a kill -9: ros::Subscriber::getNumPublishers() goes on to count
/// the connection, which roscpp tries to make again. A process that is stopped, or a cable that is
/// pulled, is not noticed here either: limits in time are for those.
class NodeWatch {
 public:
  NodeWatch();
  ~NodeWatch();
  NodeWatch(const NodeWatch&) = delete;
  NodeWatch& operator=(const NodeWatch&) = delete;

  /// Something has come from this node, so it lives. The first time, its address is asked for.
  /// Returns at once.
  /// @param node  resolved name
  void hear(const std::string& node);

  /// Whether the process of the node that was heard last has ended since.
  bool died() const;

 private:
  struct State;

  static void watch(const std::shared_ptr<State>& state);

  std::shared_ptr<State> state_;  // shared with the thread, which may outlive this
};

}  // namespace ddm
