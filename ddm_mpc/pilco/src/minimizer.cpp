// Unconstrained minimisation by (L-)BFGS with limits, whose word is checked.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/minimizer.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace ddm {
namespace pilco {
namespace {

/// Counts evaluations, refuses those beyond the limit, and remembers the best.
class Recorder : public ceres::FirstOrderFunction {
 public:
  Recorder(const DifferentiableFunction& f, int num_parameters, int max_evaluations, Minimum* out)
      : f_(f), num_parameters_(num_parameters), max_evaluations_(max_evaluations), out_(*out) {}

  bool Evaluate(const double* x, double* value, double* gradient) const override {
    if (limitReached()) return false;
    const Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(x, num_parameters_);
    if (!point.allFinite()) return false;
    ++out_.evaluations;
    if (gradient == nullptr) {
      *value = f_(point, nullptr);
      return std::isfinite(*value);
    }
    Eigen::VectorXd slope(num_parameters_);
    *value = f_(point, &slope);
    if (!std::isfinite(*value) || !slope.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(gradient, num_parameters_) = slope;
    const bool is_start = out_.gradient.size() == 0;
    if (is_start || *value < out_.cost) {
      out_.x = point;
      out_.gradient = slope;
      out_.cost = *value;
    }
    if (is_start) out_.initial_cost = *value;
    return true;
  }
  int NumParameters() const override { return num_parameters_; }
  bool limitReached() const { return max_evaluations_ > 0 && out_.evaluations >= max_evaluations_; }

 private:
  DifferentiableFunction f_;
  int num_parameters_;
  int max_evaluations_;
  Minimum& out_;
};

/// Ends a search whose iterations hardly change the cost. The solver's own test compares the change
/// with the cost and not with its magnitude: it never ends a search with negative costs.
class ChangeWatcher : public ceres::IterationCallback {
 public:
  explicit ChangeWatcher(double tolerance) : tolerance_(tolerance) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const double last = last_cost_;
    last_cost_ = summary.cost;
    if (summary.iteration == 0) return ceres::SOLVER_CONTINUE;
    const double magnitude = std::max(std::abs(last), std::abs(summary.cost));
    return std::abs(summary.cost - last) <= tolerance_ * magnitude
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  double tolerance_;
  double last_cost_ = 0.0;
};

ceres::GradientProblemSolver::Options solverOptions(const MinimizerOptions& options,
                                                    ChangeWatcher* watcher) {
  ceres::GradientProblemSolver::Options out;
  out.line_search_direction_type = options.limited_memory ? ceres::LBFGS : ceres::BFGS;
  out.max_num_iterations = options.max_iterations;
  out.function_tolerance = 0.0;  // see ChangeWatcher
  out.callbacks.push_back(watcher);
  out.gradient_tolerance = options.gradient_tolerance;
  out.parameter_tolerance = 1e-14;
  out.logging_type = ceres::SILENT;
  return out;
}

/// Fills `converged` and `message`.
void describe(const ceres::GradientProblemSolver::Summary& summary, bool evaluation_limit,
              double gradient_tolerance, Minimum* result) {
  const double slope = result->gradient.lpNorm<Eigen::Infinity>();
  const bool stationary = slope <= gradient_tolerance;
  const bool solver_content = summary.termination_type == ceres::CONVERGENCE ||
                              summary.termination_type == ceres::USER_SUCCESS;
  result->converged = stationary || (solver_content && result->improved);
  std::ostringstream text;
  if (result->converged) {
    text << "converged";
  } else if (evaluation_limit) {
    text << "limit of evaluations reached";
  } else if (summary.termination_type == ceres::NO_CONVERGENCE) {
    text << "limit of iterations reached";
  } else {
    text << (result->improved ? "no further step" : "no step")
         << " lowers the cost, though its gradient has an entry of magnitude " << slope;
    if (!solver_content) text << ": " << summary.message;
  }
  result->message = text.str();
}

}  // namespace

Minimum minimize(const DifferentiableFunction& f, const Eigen::VectorXd& start,
                 const MinimizerOptions& options) {
  if (start.size() == 0 || !start.allFinite()) {
    throw std::invalid_argument("the start of a minimisation must be finite numbers, got " +
                                (start.size() == 0 ? "none" : std::string("others")));
  }
  if (options.max_iterations < 0 || options.max_evaluations < 0) {
    throw std::invalid_argument("the limits of a minimisation must be >= 0");
  }
  Minimum result;
  result.x = start;
  // The problem owns the recorder.
  auto* const recorder =
      new Recorder(f, static_cast<int>(start.size()), options.max_evaluations, &result);
  const ceres::GradientProblem problem(recorder);
  ceres::GradientProblemSolver::Summary summary;
  Eigen::VectorXd x = start;
  ChangeWatcher watcher(options.function_tolerance);
  ceres::Solve(solverOptions(options, &watcher), problem, x.data(), &summary);
  result.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  result.start_ok = result.gradient.size() > 0;
  if (!result.start_ok) {
    result.message = "the function cannot be evaluated at the start";
    return result;
  }
  result.improved = result.cost < result.initial_cost;
  describe(summary, recorder->limitReached(), options.gradient_tolerance, &result);
  return result;
}

}  // namespace pilco
}  // namespace ddm
