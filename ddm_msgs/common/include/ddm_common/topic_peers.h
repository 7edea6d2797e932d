// Queries which nodes publish a topic and whether publishers and subscribers are connected.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ddm {

/// Address of the XML-RPC server of a node.
struct NodeAddress {
  std::string host;
  std::uint32_t port = 0;
};

/// Calls a method of the ROS master.
/// @return the answer; empty if there is no master or no answer within five seconds. A stopped
///         master accepts the request and never answers
std::optional<XmlRpc::XmlRpcValue> askMaster(const std::string& method,
                                             const XmlRpc::XmlRpcValue& request);

/// Returns the address under which a node has registered; empty if the master does not have the
/// node or does not answer.
/// @param node  resolved name
std::optional<NodeAddress> addressOf(const std::string& node);

/// Refuses to start a second node of the same name. When a node registers, the master ends the node
/// that had its name: a second launch would end the nodes of the first launch and take the motors
/// from a robot. Call this function after ros::init() and before the first node handle, which
/// registers the node. If two nodes start at the same time, both may pass.
/// @throws std::runtime_error with name and address if another node with the name of this node
///         answers
void requireFreeName();

/// Returns "publisher(s) of /torque: /mpc_node" or "nobody publishes /torque", according to the
/// master.
/// @param topic  resolved name
std::string describePublishers(const std::string& topic);

/// As describePublishers(), for an image topic. Adds a remedy if the images are published as
/// another type or only compressed.
/// @param topic     resolved name
/// @param argument  launch argument by which the user chooses another topic, such as "camera:=";
///         for the remedy
std::string describeImagePublishers(const std::string& topic, const std::string& argument);

/// Returns the connections between publishers and subscribers of the topics that do not exist yet.
/// Asks each publisher for its connections, because a message is lost until the publisher has made
/// the connection, and the subscriber counts the publisher before that moment.
/// @param topics  resolved names
/// @return "/sim_node -> /mpc_node on /camera/image_raw" for each missing connection
std::vector<std::string> missingConnections(const std::vector<std::string>& topics);

/// Finds the topics that several other nodes publish; this node is not counted.
/// @param topics  resolved names
/// @return "/torque: /intruder, /mpc_node" for each such topic
std::vector<std::string> sharedTopics(const std::vector<std::string>& topics);

}  // namespace ddm
