// Who is at the other end of a topic, for messages that name the silent side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>

#include <optional>
#include <string>

namespace ddm {

/// Calls a method of the master's interface.
/// @return its answer; empty if there is no master, or none within five seconds: one that was
///         stopped takes the question and never answers
std::optional<XmlRpc::XmlRpcValue> askMaster(const std::string& method,
                                             const XmlRpc::XmlRpcValue& request);

/// "publisher(s) of /torque: /mpc_node" or "nobody publishes /torque", as the master knows it.
/// @param topic  resolved name
std::string describePublishers(const std::string& topic);

}  // namespace ddm
