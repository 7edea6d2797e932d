// Planner: the torques u_0 ... u_{K-1} that minimise the plan cost, by BFGS from several starts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "ddm_mpc/mpc_options.h"
#include "ddm_mpc/plan_cost.h"

namespace ddm {

/// How a plan came to be.
enum class PlanStatus {
  kConverged,       ///< the solver met its tolerance
  kIterationLimit,  ///< usable; the search ended before that
  kTimeLimit,       ///< usable; the search was stopped, this is the best plan it had found
  kFailed,          ///< no usable plan
};

/// A plan and what it took to find it.
struct Plan {
  PlanStatus status = PlanStatus::kFailed;
  std::string message;           ///< why it failed
  Eigen::MatrixXd torques;       ///< u_0 ... u_{K-1} [N m]             [torque_dim x K]
  Eigen::MatrixXd features;      ///< z_0, predicted z_1 ... z_K        [feature_dim x (K + 1)]
  Eigen::VectorXd goal_feature;  ///< z_ref                         [feature_dim]
  double cost = std::numeric_limits<double>::quiet_NaN();  ///< J; NaN where it failed
  int iterations = 0;                                      ///< over all starts
  int evaluations = 0;                                     ///< over all starts
  double solve_time = 0.0;                                 ///< wall time [s]
};

/// Minimises J(U) by BFGS (paper, Sec. 3.1) and keeps the best of several starts: what the cost
/// proposes, if it does, the last plan moved on by one step, then no torque, then constant torques
/// drawn at random. The bound holds by construction, u = max_torque tanh(v): clipping afterwards
/// would bias the plan.
class Planner {
 public:
  /// @param cost  of plans from the current state on; outlives the planner
  /// @throws std::invalid_argument if max_torque is for another number of motors
  Planner(PlanCost* cost, const MpcOptions& options);

  /// Forgets the last plan: the next problem is the first of a trial.
  void clear() { last_v_.resize(0, 0); }

  /// Never throws for numerical trouble: the status tells.
  /// @param rng   draws the random starts
  /// @param stop  asked before each evaluation of the cost but the first: true ends the search
  ///              over all starts, and the best plan evaluated so far counts; empty: never
  Plan solve(std::mt19937_64* rng, const std::function<bool()>& stop = {});

 private:
  Eigen::MatrixXd unbounded(const Eigen::MatrixXd& torques) const;
  Eigen::MatrixXd startOf(int start, std::mt19937_64* rng) const;

  MpcOptions options_;
  PlanCost& cost_;
  Eigen::VectorXd max_torque_;  // of each motor [N m]
  Eigen::MatrixXd last_v_;      // unbounded variables of the last plan; empty: none
};

}  // namespace ddm
