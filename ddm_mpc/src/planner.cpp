// Planner: the torques u_0 ... u_{K-1} that minimise the plan cost, by BFGS from several starts.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/planner.h"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace ddm {
namespace {

constexpr double kMaxV = 3.0;  // tanh(3) = 0.995: a start beyond it would hardly feel a gradient

/// J as a function of v, with u = max_torque tanh(v).
class BoundedCost : public ceres::FirstOrderFunction {
 public:
  BoundedCost(PlanCost* cost, double max_torque)
      : cost_(cost), max_torque_(max_torque), torques_(cost->torqueDim(), cost->horizon()) {}

  bool Evaluate(const double* v, double* value, double* gradient) const override {
    const Eigen::Map<const Eigen::ArrayXXd> v_map(v, torques_.rows(), torques_.cols());
    torques_ = max_torque_ * v_map.tanh();
    *value = cost_->evaluate(torques_, gradient != nullptr ? &d_torques_ : nullptr);
    ++evaluations_;
    if (gradient != nullptr) {
      Eigen::Map<Eigen::ArrayXXd>(gradient, torques_.rows(), torques_.cols()) =
          d_torques_.array() * (max_torque_ - torques_.array().square() / max_torque_);
    }
    return std::isfinite(*value) && (gradient == nullptr || d_torques_.allFinite());
  }
  int NumParameters() const override { return static_cast<int>(torques_.size()); }
  int evaluations() const { return evaluations_; }

 private:
  PlanCost* cost_;
  double max_torque_;
  mutable Eigen::MatrixXd torques_;
  mutable Eigen::MatrixXd d_torques_;
  mutable int evaluations_ = 0;
};

ceres::GradientProblemSolver::Options solverOptions(const MpcOptions& mpc) {
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = mpc.max_iterations;
  options.function_tolerance = mpc.function_tolerance;
  options.gradient_tolerance = 1e-8;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

Planner::Planner(PlanCost* cost, const MpcOptions& options) : options_(options), cost_(*cost) {}

/// Unbounded variables that start number `start` begins with.
Eigen::MatrixXd Planner::startOf(int start, std::mt19937_64* rng) const {
  const int dim = cost_.torqueDim();
  const int K = cost_.horizon();
  if (start == 0 && last_v_.size() > 0) {
    Eigen::MatrixXd v(dim, K);
    const int last = static_cast<int>(last_v_.cols()) - 1;  // not K - 1 after a change of horizon
    for (int k = 0; k < K; ++k) v.col(k) = last_v_.col(std::min(k + 1, last));
    return v.cwiseMax(-kMaxV).cwiseMin(kMaxV);
  }
  if (start <= 1 && (start == 0 || last_v_.size() > 0)) return Eigen::MatrixXd::Zero(dim, K);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::VectorXd level(dim);
  for (int i = 0; i < dim; ++i) level[i] = std::atanh(0.95 * uniform(*rng));
  return level.replicate(1, K);
}

Plan Planner::solve(std::mt19937_64* rng) {
  const auto begin = std::chrono::steady_clock::now();
  Plan plan;
  plan.goal_feature = cost_.goalFeature();
  plan.message = "no start led to a finite cost";
  auto* const function = new BoundedCost(&cost_, options_.max_torque);
  const ceres::GradientProblem problem(function);  // owns the function
  const ceres::GradientProblemSolver::Options options = solverOptions(options_);

  Eigen::MatrixXd best_v;
  for (int start = 0; start < options_.num_starts; ++start) {
    Eigen::MatrixXd v = startOf(start, rng);
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, v.data(), &summary);
    plan.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    // Not the solver's word: where a start is an optimum already, it reports no iteration and no
    // cost.
    const double cost =
        v.allFinite() ? cost_.evaluate(options_.max_torque * v.array().tanh().matrix(), nullptr)
                      : std::numeric_limits<double>::quiet_NaN();
    if (std::isfinite(cost) && (best_v.size() == 0 || cost < plan.cost)) {
      best_v = v;
      plan.cost = cost;
      plan.status = summary.termination_type == ceres::CONVERGENCE ? PlanStatus::kConverged
                                                                   : PlanStatus::kIterationLimit;
      plan.message.clear();
    }
  }
  plan.evaluations = function->evaluations();
  if (best_v.size() > 0) {
    plan.torques = options_.max_torque * best_v.array().tanh();
    cost_.evaluate(plan.torques, nullptr);
    plan.features = cost_.predictedFeatures();
  } else {
    plan.torques = Eigen::MatrixXd::Zero(cost_.torqueDim(), cost_.horizon());
  }
  last_v_ = best_v;
  plan.solve_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return plan;
}

}  // namespace ddm
