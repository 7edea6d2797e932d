// The first time on /clock, which comes late or never.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ddm {

/// Waits until it is there, where /use_sim_time says that it is due. To be called before an action
/// client is made, which would wait without a limit.
/// @param limit  wall time [s]
/// @throws std::runtime_error after the limit, with those who should publish it
void waitForSimulatedTime(double limit);

}  // namespace ddm
