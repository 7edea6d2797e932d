// Who is at the other end of a topic, for messages that name the silent side.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ddm {

/// "publisher(s) of /torque: /mpc_node" or "nobody publishes /torque", as the master knows it.
/// @param topic  resolved name
std::string describePublishers(const std::string& topic);

}  // namespace ddm
