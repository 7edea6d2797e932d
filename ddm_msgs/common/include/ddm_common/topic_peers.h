// Who is at the other end of a topic, and whether they have found each other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ddm {

struct NodeAddress {
  std::string host;
  std::uint32_t port = 0;
};

/// Calls a method of the master's interface.
/// @return its answer; empty if there is no master, or none within five seconds: one that was
///         stopped takes the question and never answers
std::optional<XmlRpc::XmlRpcValue> askMaster(const std::string& method,
                                             const XmlRpc::XmlRpcValue& request);

/// Where a node was when it registered; empty if the master does not know it, or does not
/// answer.
/// @param node  resolved name
std::optional<NodeAddress> addressOf(const std::string& node);

/// When a node registers, the master ends the one that had its name: a second launch would end the
/// nodes of the first, and take the motors from a robot. To be called after ros::init() and before the
/// first node handle, which registers. Where two nodes start at once, both may pass.
/// @throws std::runtime_error with name and address if a node with the name of this one answers
void requireFreeName();

/// "publisher(s) of /torque: /mpc_node" or "nobody publishes /torque", as the master knows it.
/// @param topic  resolved name
std::string describePublishers(const std::string& topic);

/// The same for a topic of images, with a remedy where images are published in another form: as
/// another type, or only compressed.
/// @param topic     resolved name
/// @param argument  for the remedy: how the user names another topic, such as "camera:="
std::string describeImagePublishers(const std::string& topic, const std::string& argument);

/// Asks each publisher of the topics for its connections. Messages are safe only from the moment
/// the publisher has made the connection; the subscriber counts the publisher before that.
/// @param topics  resolved names
/// @return "/sim_node -> /mpc_node on /camera/image_raw" for each connection that is still missing
std::vector<std::string> missingConnections(const std::vector<std::string>& topics);

/// Other nodes than this one that publish a topic, as the master knows them: "/a, /b".
/// @param topic  resolved name
std::string otherPublishers(const std::string& topic);

/// @param topics  resolved names
/// @return "/torque: /intruder, /mpc_node" for each topic that more than one node publishes, this
/// one, which knows what it publishes, not counted
std::vector<std::string> sharedTopics(const std::vector<std::string>& topics);

}  // namespace ddm
