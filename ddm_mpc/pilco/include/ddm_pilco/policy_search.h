// Policy search: the policy parameters that minimise the expected long-term cost.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/minimise.h>
#include <ddm_params/option_checks.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace ddm::pilco {

/// Block `policy_search`. Defaults are those of the published PILCO code.
struct PolicySearchOptions {
  int max_iterations = 75;           ///< line searches of BFGS for each trial [-]
  int max_evaluations = 1500;        ///< of the cost with its gradient, for each trial [-]
  double function_tolerance = 1e-8;  ///< stop when the cost changes by less than this fraction [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("max_iterations", max_iterations);
    visitor("max_evaluations", max_evaluations);
    visitor("function_tolerance", function_tolerance);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
    OptionChecks search("policy_search");
    search.requireAtLeast("max_iterations", max_iterations, 0);
    search.requireAtLeast("max_evaluations", max_evaluations, 1);
    search.requireFraction("function_tolerance", function_tolerance);
    return search.problems();
  }
};

/// Minimises J(parameters) by BFGS from `start`. A policy for which J is not finite (a predicted
/// distribution that grows without bound) makes the line search take a shorter step.
/// @param cost   J, with its gradient
/// @param start  parameters of the last trial's policy                                     [P]
/// @throws std::invalid_argument if the options are invalid, or the start is empty or not finite
inline Minimum searchPolicy(const DifferentiableFunction& cost, const Eigen::VectorXd& start,
                            const PolicySearchOptions& options) {
  requireNone(options.problems());
  MinimiseOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.max_evaluations = options.max_evaluations;
  solver.function_tolerance = options.function_tolerance;
  return minimise(cost, start, solver);
}

}  // namespace ddm::pilco
