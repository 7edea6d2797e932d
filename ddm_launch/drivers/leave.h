// The end of a node that ends by itself.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {

/// Call it before what belongs to ROS is destroyed, which tells the master for each topic that this
/// node goes: one that was stopped never answers. After ten seconds the process ends all the same,
/// with this exit code.
void leaveWithin10s(int code);

}  // namespace ddm
