// SIGINT and SIGTERM for nodes that have a last message to send.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <csignal>

namespace ddm {
namespace internal {

inline volatile std::sig_atomic_t end_requested = 0;

inline void requestEnd(int /*signal*/) { end_requested = 1; }

}  // namespace internal

/// From now on SIGINT and SIGTERM set endRequested() and do nothing else. roscpp's own handler
/// shuts all topics down before a zero can be sent to the motors: call ros::init() with
/// NoSigintHandler.
inline void catchEndSignals() {
  std::signal(SIGINT, internal::requestEnd);
  std::signal(SIGTERM, internal::requestEnd);
}

inline bool endRequested() { return internal::end_requested != 0; }

}  // namespace ddm
