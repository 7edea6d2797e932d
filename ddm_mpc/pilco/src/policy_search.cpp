// Policy search: the policy parameters that minimise the expected long-term cost.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/policy_search.h"

#include <stdexcept>

#include "option_rules.h"

namespace ddm {
namespace pilco {

std::vector<std::string> PolicySearchOptions::problems() const {
  OptionRules rules("policy_search");
  rules.require(max_iterations >= 0, "max_iterations must be >= 0", max_iterations);
  rules.require(max_evaluations >= 1, "max_evaluations must be >= 1", max_evaluations);
  rules.require(function_tolerance >= 0.0 && function_tolerance < 1.0,
                "function_tolerance must lie in [0, 1)", function_tolerance);
  return rules.problems();
}

PolicySearchResult searchPolicy(const DifferentiableFunction& cost, const Eigen::VectorXd& start,
                                const PolicySearchOptions& options) {
  const std::vector<std::string> problems = options.problems();
  if (!problems.empty()) throw std::invalid_argument(problems.front());
  MinimiseOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.max_evaluations = options.max_evaluations;
  solver.function_tolerance = options.function_tolerance;
  const Minimum minimum = minimise(cost, start, solver);
  PolicySearchResult result;
  result.ok = minimum.reason != MinimumReason::kStartFailed;
  result.improved = minimum.improved();
  result.parameters = minimum.x;
  result.cost_before = minimum.initial_cost;
  result.cost_after = minimum.cost;
  result.iterations = minimum.iterations;
  result.evaluations = minimum.evaluations;
  result.message = minimum.message;
  return result;
}

}  // namespace pilco
}  // namespace ddm
