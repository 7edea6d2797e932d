// Unconstrained minimisation by BFGS or L-BFGS: for training, planning and PILCO.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/minimise.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <ddm_common/option_checks.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace ddm {
namespace {

/// One search. Evaluates the function until a limit is reached, and stores the best point.
class Search : public ceres::IterationCallback {
 public:
  Search(const DifferentiableFunction& f, const Eigen::VectorXd& start,
         const MinimiseOptions& options)
      : f_(f), options_(options), point_(start), slope_(start.size()) {
    best_.x = start;
  }

  Eigen::Index size() const { return point_.size(); }

  /// Implements ceres::FirstOrderFunction::Evaluate().
  bool evaluate(const double* x, double* value, double* gradient) {
    point_ = Eigen::Map<const Eigen::VectorXd>(x, size());
    if (!point_.allFinite() || ended()) return false;
    ++best_.evaluations;
    *value = f_(point_, &slope_);
    if (!std::isfinite(*value) || !slope_.allFinite()) return false;
    if (gradient != nullptr) Eigen::Map<Eigen::VectorXd>(gradient, size()) = slope_;
    if (!anyPoint()) best_.initial_cost = *value;  // the solver evaluates the initial point first
    if (*value < best_.cost) {
      best_.x = point_;
      best_.gradient = slope_;
      best_.cost = *value;
    }
    return true;
  }

  /// Ends the search if an iteration hardly changes the cost. Ceres divides the change by the cost
  /// instead of its magnitude, and so never ends a search whose costs are negative.
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const double last = accepted_cost_;
    accepted_cost_ = summary.cost;
    best_.iterations = summary.iteration;
    if (options_.on_iteration && !options_.on_iteration(best_))
      ended_by_ = TerminationReason::kStopped;
    if (ended_by_) return ceres::SOLVER_ABORT;
    if (summary.iteration == 0) return ceres::SOLVER_CONTINUE;
    const double magnitude = std::max(std::abs(last), std::abs(summary.cost));
    return std::abs(summary.cost - last) <= options_.function_tolerance * magnitude
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

  /// @param summary  summary of the solver after its end
  SolverResult result(const ceres::GradientProblemSolver::Summary& summary) && {
    // Only USER_SUCCESS, which operator() returns, means convergence. Ceres also reports
    // convergence when a line search returns to its initial point.
    best_.reason = reason(summary.termination_type == ceres::USER_SUCCESS,
                          summary.termination_type == ceres::NO_CONVERGENCE);
    best_.message = message();
    if (best_.reason == TerminationReason::kNoDecrease &&
        summary.termination_type == ceres::FAILURE) {
      best_.message += ": " + summary.message;
    }
    return std::move(best_);
  }

 private:
  bool anyPoint() const { return best_.gradient.size() > 0; }

  /// @return whether the function must not be evaluated again; once true, always true
  bool ended() {
    if (!ended_by_ && options_.max_evaluations > 0 &&
        best_.evaluations >= options_.max_evaluations) {
      ended_by_ = TerminationReason::kEvaluationLimit;
    }
    if (!ended_by_ && options_.stop && options_.stop()) ended_by_ = TerminationReason::kStopped;
    return ended_by_.has_value();
  }

  double slope() const { return best_.gradient.lpNorm<Eigen::Infinity>(); }

  TerminationReason reason(bool hardly_changed, bool iteration_limit) const {
    if (ended_by_) return *ended_by_;
    if (!anyPoint()) return TerminationReason::kStartFailed;
    if (slope() <= options_.gradient_tolerance || (hardly_changed && best_.improved())) {
      return TerminationReason::kConverged;
    }
    return iteration_limit ? TerminationReason::kIterationLimit : TerminationReason::kNoDecrease;
  }

  std::string message() const {
    static const std::map<TerminationReason, std::string> texts = {
        {TerminationReason::kConverged, "converged"},
        {TerminationReason::kIterationLimit, "limit of iterations reached"},
        {TerminationReason::kEvaluationLimit, "limit of evaluations reached"},
        {TerminationReason::kStopped, "stopped"},
        {TerminationReason::kStartFailed, "the function cannot be evaluated at the start"}};
    const auto found = texts.find(best_.reason);
    if (found != texts.end()) return found->second;
    return textOf(best_.improved() ? "no further step" : "no step",
                  " lowers the cost, though its gradient has an entry of magnitude ", slope());
  }

  const DifferentiableFunction& f_;
  const MinimiseOptions& options_;
  SolverResult best_;
  Eigen::VectorXd point_;
  Eigen::VectorXd slope_;
  double accepted_cost_ = 0.0;  // of the last iteration
  // Limit that ended the search, unless Ceres checks it.
  std::optional<TerminationReason> ended_by_;
};

class CeresFunction : public ceres::FirstOrderFunction {
 public:
  explicit CeresFunction(Search* search) : search_(*search) {}
  bool Evaluate(const double* x, double* value, double* gradient) const override {
    return search_.evaluate(x, value, gradient);
  }
  int NumParameters() const override { return static_cast<int>(search_.size()); }

 private:
  Search& search_;
};

ceres::GradientProblemSolver::Options solverOptions(const MinimiseOptions& options,
                                                    ceres::IterationCallback* callback) {
  ceres::GradientProblemSolver::Options out;
  out.line_search_direction_type = options.lbfgs_rank > 0 ? ceres::LBFGS : ceres::BFGS;
  if (options.lbfgs_rank > 0) out.max_lbfgs_rank = options.lbfgs_rank;
  out.max_num_iterations = options.max_iterations;
  out.function_tolerance = 0.0;  // operator() tests it instead
  out.gradient_tolerance = options.gradient_tolerance;
  out.parameter_tolerance = 0.0;  // a short step alone does not mean convergence
  out.callbacks.push_back(callback);
  out.logging_type = ceres::SILENT;
  return out;
}

}  // namespace

SolverResult minimise(const DifferentiableFunction& f, const Eigen::VectorXd& start,
                      const MinimiseOptions& options) {
  eigen_assert(start.size() > 0);
  Search search(f, start, options);
  const ceres::GradientProblem problem(new CeresFunction(&search));  // owns the function
  ceres::GradientProblemSolver::Summary summary;
  Eigen::VectorXd x = start;
  ceres::Solve(solverOptions(options, &search), problem, x.data(), &summary);
  return std::move(search).result(summary);
}

void silenceSolverLog() { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace ddm
