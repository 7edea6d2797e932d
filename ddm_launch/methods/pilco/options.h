// Parameters of PILCO, which pilco.yaml explains.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <string>
#include <vector>

namespace ddm::pilco {

/// Block `pilco`. No other method reads it.
struct PilcoOptions {
  int hyperparameter_iterations = 300;  ///< limit on the BFGS iterations for each output [-]
  int hyperparameter_points = 0;  ///< size of a random subset to learn them from; 0: all data [-]
  int max_points = 300;           ///< largest full GP, and number of inducing inputs [-]
  int first_inducing_iterations = 1500;  ///< L-BFGS iterations on the first inducing inputs [-]
  int inducing_iterations = 500;         ///< L-BFGS iterations on inducing inputs later [-]
  int policy_evaluations = 1500;  ///< limit on the evaluations of J and gradient in each trial [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("hyperparameter_iterations", hyperparameter_iterations);
    visitor("hyperparameter_points", hyperparameter_points);
    visitor("max_points", max_points);
    visitor("first_inducing_iterations", first_inducing_iterations);
    visitor("inducing_iterations", inducing_iterations);
    visitor("policy_evaluations", policy_evaluations);
  }
  /// All problems with these values, in words a user can act on. Empty if the values are valid.
  std::vector<std::string> problems() const {
    OptionChecks checks("pilco");
    checks.requireWithin("hyperparameter_iterations", hyperparameter_iterations, 0, 1000000);
    checks.require(hyperparameter_points == 0 || hyperparameter_points >= 2,
                   "hyperparameter_points", "be 0 or >= 2", hyperparameter_points);
    checks.requireAtLeast("max_points", max_points, 1);
    checks.requireWithin("first_inducing_iterations", first_inducing_iterations, 0, 1000000);
    checks.requireWithin("inducing_iterations", inducing_iterations, 0, 1000000);
    checks.requireAtLeast("policy_evaluations", policy_evaluations, 1);
    return checks.problems();
  }
};

}  // namespace ddm::pilco
