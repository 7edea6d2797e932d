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
  std::string cost = "distance";  ///< of a step: "distance" to the goal, or "time" to get there
  double control_weight = 0.01;   ///< lambda, weight of torque [(N m)^-2], with cost time [-]
  double offset_gain = 0.0;       ///< share of a prediction error that corrects later ones [-]
  std::vector<double> max_torque = {6.0};  ///< bound on |u|; one, or one per motor [N m]
  double epsilon = 0.2;                    ///< probability of a uniformly random torque [-]
  int hold_steps = 1;                      ///< steps for which a random torque is held [-]
  int num_starts = 3;                      ///< initial plans that the solver starts from [-]
  int max_iterations = 40;                 ///< cap on the BFGS iterations of each start [-]
  double function_tolerance = 1e-4;  ///< stop when the cost changes by less than this fraction [-]
  double time_budget = 0.0;  ///< from an image to the end of the search for its plan; 0: none [s]

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
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
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
};

/// Block `controller`: parameters of mpc_node beyond the planner's.
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
