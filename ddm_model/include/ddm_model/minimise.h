// Unconstrained minimisation by BFGS or L-BFGS: for training, planning and PILCO.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>

namespace ddm {

/// A differentiable function. Sets its gradient where `gradient` is not null. A value or a gradient
/// that is not finite means that the function cannot be evaluated at x.
using DifferentiableFunction =
    std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd* gradient)>;

/// Why a minimisation ended.
enum class MinimumReason {
  kConverged,        ///< the gradient vanishes, or a search that lowered the cost hardly changes it
  kIterationLimit,   ///< max_iterations
  kEvaluationLimit,  ///< max_evaluations
  kStopped,          ///< by `stop` or `on_iteration`
  kNoDecrease,       ///< no step lowers the cost, though the gradient does not vanish
  kStartFailed,      ///< the function cannot be evaluated at the start
};

/// The best point that was evaluated, and why the search ended.
struct Minimum {
  MinimumReason reason = MinimumReason::kStartFailed;
  std::string message;       ///< the reason in words
  Eigen::VectorXd x;         ///< the best point evaluated; the initial point if there is none  [n]
  Eigen::VectorXd gradient;  ///< there                        [n], empty if there is none
  double cost = std::numeric_limits<double>::infinity();          ///< there
  double initial_cost = std::numeric_limits<double>::infinity();  ///< at the initial point
  int iterations = 0;                                             ///< line searches
  int evaluations = 0;                                            ///< of the function

  bool converged() const { return reason == MinimumReason::kConverged; }
  bool improved() const { return cost < initial_cost; }
};

/// How to search, and when to end.
struct MinimiseOptions {
  int lbfgs_rank = 0;                 ///< steps that L-BFGS remembers; 0: BFGS, for few parameters
  int max_iterations = 100;           ///< line searches [-]
  int max_evaluations = 0;            ///< of the function; 0: no limit [-]
  double function_tolerance = 1e-10;  ///< end when an iteration changes the cost, which may be
                                      ///< negative, by no more than this fraction [-]
  double gradient_tolerance = 1e-7;   ///< end when no entry of the gradient is larger
  /// Called before each evaluation, also before the first; true ends the search.
  std::function<bool()> stop;
  /// Called with the best so far before the first iteration and after each; false ends the search.
  std::function<bool(const Minimum& so_far)> on_iteration;
};

/// Minimises f from an initial point. Where f cannot be evaluated, the line search takes a shorter step. The result is
/// never worse than the initial point, however the search ends. The reason does not rely on the verdict of the solver,
/// which may call a search successful although no step lowered the cost.
/// @throws std::invalid_argument if the initial point is empty or not finite, or a limit is negative;
///         whatever f, stop and on_iteration throw
Minimum minimise(const DifferentiableFunction& f, const Eigen::VectorXd& start,
                 const MinimiseOptions& options);

/// Ceres warns on stderr about line searches over flat functions, which are no news to a user: how
/// a solver ended is in every result. Called once by a program, never by a library.
void silenceSolverLog();

}  // namespace ddm
