// Unconstrained minimisation by (L-)BFGS with limits, whose word is checked.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace ddm {
namespace pilco {

/// A differentiable function. Sets its gradient where `gradient` is not null. A point where it
/// cannot be evaluated is told by a value or a gradient that is not finite.
using DifferentiableFunction =
    std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd* gradient)>;

/// A line search takes about two evaluations; one that takes many more has lost its way in rounding
/// errors. Limit for searches whose evaluations are dear.
constexpr int kEvaluationsPerIteration = 3;

struct MinimizerOptions {
  bool limited_memory = false;        ///< L-BFGS instead of BFGS: for many parameters
  int max_iterations = 100;           ///< [-]
  int max_evaluations = 0;            ///< of the function; 0: no limit [-]
  double function_tolerance = 1e-10;  ///< stop when an iteration changes the cost, which may be
                                      ///< negative, by no more than this fraction [-]
  double gradient_tolerance = 1e-7;   ///< stop when no entry of the gradient is larger
};

struct Minimum {
  bool start_ok = false;  ///< whether the function could be evaluated at the start
  bool improved = false;  ///< cost < initial_cost
  /// Whether no entry of the gradient is larger than the tolerance, or a search that improved the
  /// cost ended as it hardly changed any more. Otherwise the message says what stopped it.
  bool converged = false;
  Eigen::VectorXd x;          ///< the best point evaluated; the start if there is none better
  Eigen::VectorXd gradient;   ///< there
  double cost = 0.0;          ///< there
  double initial_cost = 0.0;  ///< at the start
  int iterations = 0;         ///< line searches
  int evaluations = 0;        ///< of the function
  std::string message;        ///< why it ended, in words
};

/// Minimises f from `start`. A point that cannot be evaluated makes the line search take a shorter
/// step. `improved` compares costs: a solver may call a search successful that went nowhere.
/// @throws std::invalid_argument if the start is empty or not finite, or a limit is negative;
///         whatever f throws
Minimum minimize(const DifferentiableFunction& f, const Eigen::VectorXd& start,
                 const MinimizerOptions& options);

}  // namespace pilco
}  // namespace ddm
