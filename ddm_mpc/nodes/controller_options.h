// Parameters of mpc_node beyond the planner's. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>
#include <vector>

namespace ddm {

/// Block `controller`.
struct ControllerOptions {
  int torque_dim = 1;    ///< number of motors; a random trial has no model to take it from [-]
  double timeout = 5.0;  ///< wall time that an image or the model may take to arrive [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("torque_dim", torque_dim);
    visitor("timeout", timeout);
  }
  std::vector<std::string> problems() const {
    std::vector<std::string> out;
    if (!(torque_dim >= 1 && torque_dim <= 1000)) {
      out.push_back("controller/torque_dim must lie in [1, 1000], got " +
                    std::to_string(torque_dim));
    }
    if (!(timeout > 0.0 && std::isfinite(timeout))) {
      out.push_back("controller/timeout must be > 0, got " + std::to_string(timeout));
    }
    return out;
  }
};

}  // namespace ddm
