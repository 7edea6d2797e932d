// Unconstrained minimisation by BFGS or L-BFGS: for training, planning and PILCO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>

namespace ddm {

/// A differentiable function. Writes its gradient if `gradient` is not null. If the value or the
/// gradient is not finite, the function counts as undefined at x.
using DifferentiableFunction =
    std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd* gradient)>;

/// Why a minimisation ended.
enum class TerminationReason {
  /// The gradient vanishes, or an iteration hardly changes a cost that the search has lowered.
  kConverged,
  kIterationLimit,   ///< max_iterations is reached
  kEvaluationLimit,  ///< max_evaluations is reached
  kStopped,          ///< `stop` or `on_iteration` ended the search
  kNoDecrease,       ///< no step lowers the cost, although the gradient does not vanish
  kStartFailed,      ///< the initial point is not finite, or the function is undefined there
};

/// Result of a minimisation: the best evaluated point, and why the search ended.
struct SolverResult {
  TerminationReason reason = TerminationReason::kStartFailed;
  std::string message;       ///< the reason in words
  Eigen::VectorXd x;         ///< best evaluated point; the initial point if there is none  [n]
  Eigen::VectorXd gradient;  ///< gradient at x; empty if no point was evaluated  [n]
  double cost = std::numeric_limits<double>::infinity();          ///< cost at x
  double initial_cost = std::numeric_limits<double>::infinity();  ///< cost at the initial point
  int iterations = 0;                                             ///< number of line searches
  int evaluations = 0;  ///< number of evaluations of the function

  bool converged() const { return reason == TerminationReason::kConverged; }
  bool improved() const { return cost < initial_cost; }
};

/// Options of a minimisation.
struct MinimiseOptions {
  int lbfgs_rank = 0;        ///< steps that L-BFGS stores [-]; 0: BFGS, for few parameters
  int max_iterations = 100;  ///< cap on the line searches [-]
  int max_evaluations = 0;   ///< cap on the evaluations of the function [-]; 0: no limit
  /// The search ends if an iteration changes the cost by at most this fraction of its magnitude
  /// [-].
  double function_tolerance = 1e-10;
  /// The search ends if no entry of the gradient has a larger magnitude.
  double gradient_tolerance = 1e-7;
  /// Called before each evaluation, including the first. Returning true ends the search.
  std::function<bool()> stop;
  /// Called with the best point so far, before the first iteration and after each iteration.
  /// Returning false ends the search.
  std::function<bool(const SolverResult& so_far)> on_iteration;
};

/// Minimises f from an initial point (BFGS: paper, Secs. 2.3 and 3.1). The line search shortens a
/// step that ends where f is undefined. The result is never worse than the initial point. The
/// reason is determined here, because the solver reports success even if no step lowered the cost.
/// @param start  initial point, not empty  [n]
/// @throws every exception of f, stop and on_iteration
SolverResult minimise(const DifferentiableFunction& f, const Eigen::VectorXd& start,
                      const MinimiseOptions& options);

/// Silences the log of Ceres, which warns on stderr about line searches over flat functions
/// although each result already says how the search ended. Only programs call this function, once;
/// a library must not change the log of its caller.
void silenceSolverLog();

}  // namespace ddm
