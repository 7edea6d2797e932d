// Policy search: the policy parameters that minimise the expected long-term cost.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/policy_search.h"

#include <ddm_msgs/option_checks.h>

namespace ddm::pilco {

std::vector<std::string> PolicySearchOptions::problems() const {
  OptionChecks search("policy_search");
  search.requireAtLeast("max_iterations", max_iterations, 0);
  search.requireAtLeast("max_evaluations", max_evaluations, 1);
  search.requireFraction("function_tolerance", function_tolerance);
  return search.problems();
}

Minimum searchPolicy(const DifferentiableFunction& cost, const Eigen::VectorXd& start,
                     const PolicySearchOptions& options) {
  requireNone(options.problems());
  MinimiseOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.max_evaluations = options.max_evaluations;
  solver.function_tolerance = options.function_tolerance;
  return minimise(cost, start, solver);
}

}  // namespace ddm::pilco
