// Parameters of the controller and of mpc_node: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_options.h"

#include <ddm_common/option_checks.h>
#include <ddm_model/per_motor.h>

namespace ddm {

std::vector<std::string> MpcOptions::problems() const {
  OptionChecks mpc("mpc");
  mpc.requireWithin("horizon", horizon, 1, 1000);
  mpc.require(cost == "distance" || cost == "time", "cost", "be distance or time", cost);
  mpc.requireNotNegative("control_weight", control_weight);
  mpc.requireWithin("offset_gain", offset_gain, 0.0, 1.0);
  mpc.require(areLimits(max_torque), "max_torque", "be > 0 and finite", limitsText(max_torque));
  mpc.requireWithin("epsilon", epsilon, 0.0, 1.0);
  mpc.requireAtLeast("hold_steps", hold_steps, 1);
  mpc.requireWithin("num_starts", num_starts, 1, 1000);
  mpc.requireAtLeast("max_iterations", max_iterations, 1);
  mpc.requireFraction("function_tolerance", function_tolerance);
  mpc.requireNotNegative("time_budget", time_budget);
  return mpc.problems();
}

std::vector<std::string> ControllerOptions::problems() const {
  OptionChecks controller("controller");
  controller.requireWithin("torque_dim", torque_dim, 1, 1000);
  controller.requireTimeLimit("timeout", timeout);
  controller.requireWithin("dt", dt, 0.0, 1000.0);
  return controller.problems();
}

}  // namespace ddm
