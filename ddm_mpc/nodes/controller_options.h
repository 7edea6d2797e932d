// Parameters of mpc_node beyond the planner's. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_params/option_checks.h>

#include <string>
#include <vector>

namespace ddm {

/// Block `controller`.
struct ControllerOptions {
  int torque_dim = 1;    ///< number of motors; a random trial has no model to take it from [-]
  double timeout = 5.0;  ///< wall time that an image or the model may take to arrive [s]
  double dt = 0.0;       ///< time step; 0: the shortest time between two images of the trial [s]
  bool publish_effort = false;  ///< also send each torque to the motors themselves

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("torque_dim", torque_dim);
    visitor("timeout", timeout);
    visitor("dt", dt);
    visitor("publish_effort", publish_effort);
  }
  std::vector<std::string> problems() const {
    OptionChecks controller("controller");
    controller.requireWithin("torque_dim", torque_dim, 1, 1000);
    controller.requireTimeLimit("timeout", timeout);
    controller.requireWithin("dt", dt, 0.0, 1000.0);
    return controller.problems();
  }
};

}  // namespace ddm
