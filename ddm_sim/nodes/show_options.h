// Parameters of sim_node that change nothing of what happens. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Block `show`.
struct ShowOptions {
  double frame_rate = 0.0;  ///< lock-step: most frames in a second of wall time; 0: any [1/s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("frame_rate", frame_rate);
  }
  std::vector<std::string> problems() const {
    if (frame_rate == 0.0 || (frame_rate >= 1.0 && frame_rate <= 1e6)) return {};
    return {"show/frame_rate must be 0 or lie in [1, 1e6] 1/s, got " + std::to_string(frame_rate)};
  }
};

}  // namespace ddm
