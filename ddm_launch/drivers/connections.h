// Whether the publishers and subscribers of a topic have found each other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Asks each publisher of the topics for its connections: only when the publisher's side of a
/// connection stands is no message lost. (A subscriber counts a publisher too early.)
/// @param topics  resolved names
/// @return "/sim_node -> /mpc_node on /camera/image_raw" for each connection that is still missing
std::vector<std::string> missingConnections(const std::vector<std::string>& topics);

/// @param topics  resolved names
/// @return "/torque: /intruder, /mpc_node" for each topic that more than one node publishes, this
/// one, which knows what it publishes, not counted
std::vector<std::string> sharedTopics(const std::vector<std::string>& topics);

}  // namespace ddm
