// Who is at the other end of a topic, and whether they have found each other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>

#include <optional>
#include <string>
#include <vector>

namespace ddm {

/// Calls a method of the master's interface.
/// @return its answer; empty if there is no master, or none within five seconds: one that was
///         stopped takes the question and never answers
std::optional<XmlRpc::XmlRpcValue> askMaster(const std::string& method,
                                             const XmlRpc::XmlRpcValue& request);

/// When a node registers, the master ends the one that had its name: a second launch would end the
/// nodes of the first, and take the motors from a robot. To be called after ros::init() and before the
/// first node handle, which registers. Where two nodes start at once, both may pass.
/// @throws std::runtime_error with name and address if a node with the name of this one answers
void requireFreeName();

/// "publisher(s) of /torque: /mpc_node" or "nobody publishes /torque", as the master knows it.
/// @param topic  resolved name
std::string describePublishers(const std::string& topic);

/// Asks each publisher of the topics for its connections. Messages are safe only from the moment
/// the publisher has made the connection; the subscriber counts the publisher before that.
/// @param topics  resolved names
/// @return "/sim_node -> /mpc_node on /camera/image_raw" for each connection that is still missing
std::vector<std::string> missingConnections(const std::vector<std::string>& topics);

/// @param topics  resolved names
/// @return "/torque: /intruder, /mpc_node" for each topic that more than one node publishes, this
/// one, which knows what it publishes, not counted
std::vector<std::string> sharedTopics(const std::vector<std::string>& topics);

}  // namespace ddm
