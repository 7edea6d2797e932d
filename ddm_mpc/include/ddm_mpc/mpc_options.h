// Parameters of the controller and of mpc_node. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>
#include <ddm_model/per_motor.h>

#include <string>
#include <vector>

namespace ddm {

/// Block `mpc`.
struct MpcOptions {
  int horizon = 15;               ///< K, planned steps [-]
  std::string cost = "distance";  ///< "distance", "saturating" or "time", see DdmPlanCost
  double control_weight = 0.01;   ///< lambda, weight of torque [(N m)^-2]; other costs [-]
  double offset_gain = 0.0;       ///< share of a prediction error that enters the offset [-]
  std::vector<double> max_torque = {6.0};  ///< bound on |u|; one for all motors, or one each [N m]
  double epsilon = 0.2;                    ///< probability of a uniformly random torque [-]
  int hold_steps = 1;                      ///< most steps for which a random torque is held [-]
  int num_starts = 3;                      ///< initial plans of the search [-]
  int max_iterations = 40;                 ///< cap on the BFGS iterations from each of them [-]
  double function_tolerance = 1e-4;        ///< stop if J changes by less than this fraction [-]
  double time_budget = 0.0;  ///< from an image to the end of its search; 0: no limit [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("horizon", horizon);
    visitor("cost", cost);
    visitor("control_weight", control_weight);
    visitor("offset_gain", offset_gain);
    visitor("max_torque", max_torque);
    visitor("epsilon", epsilon);
    visitor("hold_steps", hold_steps);
    visitor("num_starts", num_starts);
    visitor("max_iterations", max_iterations);
    visitor("function_tolerance", function_tolerance);
    visitor("time_budget", time_budget);
  }
  /// @return all faults of these values, in words for the user; empty if the values are valid
  std::vector<std::string> problems() const {
    OptionChecks mpc("mpc");
    mpc.requireWithin("horizon", horizon, 1, 1000);
    mpc.require(cost == "distance" || cost == "saturating" || cost == "time", "cost",
                "be distance, saturating or time", cost);
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
};

/// Block `controller`: parameters of mpc_node other than those of the planner.
struct ControllerOptions {
  int torque_dim = 1;    ///< number of motors; a random trial has no model that gives it [-]
  double timeout = 5.0;  ///< wall time in which an image or the model must arrive [s]
  double dt = 0.0;       ///< time step; 0: shortest time between two images of the trial [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("torque_dim", torque_dim);
    visitor("timeout", timeout);
    visitor("dt", dt);
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
