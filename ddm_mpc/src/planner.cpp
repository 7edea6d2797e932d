// Planner: minimises the cost of a plan over its torques, by BFGS from several initial plans.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/planner.h"

#include <ddm_model/minimise.h>
#include <ddm_model/per_motor.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

namespace ddm {
namespace {

constexpr int kProposal = -1;       // number of the proposal, before the other initial plans
constexpr double kMaxShare = 0.95;  // largest |u| / max_torque of a proposed or random plan
// Cap on |v| of an initial plan. tanh(3) = 0.995: beyond it the gradient almost vanishes.
constexpr double kMaxV = 3.0;

/// J as a function of v, where u = max_torque tanh(v).
class BoundedCost {
 public:
  BoundedCost(PlanCost* cost, const Eigen::VectorXd& max_torque)
      : cost_(*cost), max_torque_(max_torque.replicate(1, cost->horizon())) {}

  Eigen::MatrixXd torquesOf(const Eigen::VectorXd& v) const {
    return max_torque_ *
           Eigen::Map<const Eigen::ArrayXXd>(v.data(), max_torque_.rows(), max_torque_.cols())
               .tanh();
  }

  double operator()(const Eigen::VectorXd& v, Eigen::VectorXd* gradient) {
    torques_ = torquesOf(v);
    const double value = cost_.evaluate(torques_, gradient != nullptr ? &d_torques_ : nullptr);
    if (gradient != nullptr) {
      Eigen::Map<Eigen::ArrayXXd>(gradient->data(), torques_.rows(), torques_.cols()) =
          d_torques_.array() * (max_torque_ - torques_.array().square() / max_torque_);
    }
    return value;
  }

 private:
  PlanCost& cost_;
  Eigen::ArrayXXd max_torque_;  // [torque_dim x K]
  Eigen::MatrixXd torques_;
  Eigen::MatrixXd d_torques_;
};

}  // namespace

Planner::Planner(PlanCost* cost, const MpcOptions& options)
    : options_(options),
      cost_(*cost),
      max_torque_(perMotor(options.max_torque, cost->torqueDim(), "mpc/max_torque")) {}

/// @return v of these torques, moved inside the bounds if they lie there  [torque_dim x K]
Eigen::MatrixXd Planner::unbounded(const Eigen::MatrixXd& torques) const {
  const Eigen::ArrayXXd share = torques.array().colwise() / max_torque_.array();
  return share.max(-kMaxShare).min(kMaxShare).unaryExpr([](double x) { return std::atanh(x); });
}

/// @return v of initial plan number `start`: the last plan shifted by one step (if there is one),
///         zero torque, then random constant torques  [torque_dim x K]
Eigen::MatrixXd Planner::startOf(int start, std::mt19937_64* rng) const {
  const int dim = cost_.torqueDim();
  const int K = cost_.horizon();
  if (start == 0 && last_v_.size() > 0) {
    Eigen::MatrixXd v(dim, K);
    for (int k = 0; k < K; ++k) v.col(k) = last_v_.col(std::min(k + 1, K - 1));
    return v.cwiseMax(-kMaxV).cwiseMin(kMaxV);
  }
  if (start <= 1 && (start == 0 || last_v_.size() > 0)) return Eigen::MatrixXd::Zero(dim, K);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::VectorXd level(dim);
  for (int i = 0; i < dim; ++i) level[i] = std::atanh(kMaxShare * uniform(*rng));
  return level.replicate(1, K);
}

Plan Planner::solve(std::mt19937_64* rng, const std::function<bool()>& stop) {
  const auto begin = std::chrono::steady_clock::now();
  BoundedCost cost(&cost_, max_torque_);
  MinimiseOptions solver;
  solver.max_iterations = options_.max_iterations;
  solver.function_tolerance = options_.function_tolerance;
  solver.gradient_tolerance = 1e-8;
  bool asked = false, stopped = false;
  if (stop) {
    solver.stop = [&] {
      stopped = asked && stop();
      asked = true;
      return stopped;
    };
  }

  Plan plan;
  plan.goal_feature = cost_.goalFeature();
  SolverResult best;
  const std::optional<Eigen::MatrixXd> proposal = cost_.proposal();
  for (int start = proposal ? kProposal : 0; start < options_.num_starts && !stopped; ++start) {
    const Eigen::MatrixXd v = start == kProposal ? unbounded(*proposal) : startOf(start, rng);
    SolverResult result =
        minimise(std::ref(cost), Eigen::Map<const Eigen::VectorXd>(v.data(), v.size()), solver);
    plan.iterations += result.iterations;
    plan.evaluations += result.evaluations;
    if (result.cost < best.cost) best = std::move(result);
  }
  if (std::isfinite(best.cost)) {
    plan.status = stopped            ? PlanStatus::kTimeLimit
                  : best.converged() ? PlanStatus::kConverged
                                     : PlanStatus::kIterationLimit;
    plan.cost = best.cost;
    last_v_ = Eigen::Map<const Eigen::MatrixXd>(best.x.data(), cost_.torqueDim(), cost_.horizon());
    plan.torques = cost.torquesOf(best.x);
    cost_.evaluate(plan.torques, nullptr);
    plan.features = cost_.predictedFeatures();
  } else {
    plan.message = "no start led to a finite cost";
    last_v_.resize(0, 0);
    plan.torques = Eigen::MatrixXd::Zero(cost_.torqueDim(), cost_.horizon());
  }
  plan.solve_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return plan;
}

}  // namespace ddm
