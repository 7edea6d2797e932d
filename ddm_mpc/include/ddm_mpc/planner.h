// Planner: minimises the cost of a plan over its torques, by BFGS from several initial plans.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include "ddm_mpc/mpc_options.h"

namespace ddm {

/// Cost J(U) of the torques U = [u_0, ..., u_{K-1}] from the current state on, which the
/// implementation stores. With `mpc/cost: distance`
///
///   J(U) = sum_{k=1}^{K} |z_k - z_ref|^2 + lambda |u_{k-1}|^2
///
/// while DdmPlanCost also implements `mpc/cost: time`. Implementations differ in their model: eq.
/// (7) of the paper plans with a known model of the state, eq. (9) with predicted features.
/// Deviation: the sum in the paper runs over z_0 ... z_{K-1}, where z_0 is constant and u_{K-1} has
/// no effect. Here it runs over the K features that the K torques lead to.
class PlanCost {
 public:
  virtual ~PlanCost() = default;

  /// @param U    torques [N m]                            [torqueDim() x horizon()]
  /// @param d_U  out: dJ/dU; null: skip [1/(N m)]         [torqueDim() x horizon()]
  /// @return     J(U)
  virtual double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) = 0;

  /// @return initial plan for the search [N m], [torqueDim() x horizon()]; empty if there is none
  virtual std::optional<Eigen::MatrixXd> proposal() { return std::nullopt; }

  /// @return z_0 and the features predicted by the last evaluate()  [feature_dim x (K + 1)]
  virtual Eigen::MatrixXd predictedFeatures() const = 0;

  virtual Eigen::VectorXd goalFeature() const = 0;  ///< z_ref  [feature_dim]
  virtual int horizon() const = 0;                  ///< K, steps
  virtual int torqueDim() const = 0;
};

/// How the search for a plan ended. The numbers are those of ddm_msgs/Plan.
enum class PlanStatus {
  kConverged = 0,       ///< usable: the search for this plan met its tolerance
  kIterationLimit = 1,  ///< usable, but the search for this plan did not meet its tolerance
  kFailed = 2,          ///< there is no usable plan
  kTimeLimit = 3,       ///< usable: the best plan when `stop` ended the search
};

/// A plan, and statistics of the search.
struct Plan {
  PlanStatus status = PlanStatus::kFailed;
  std::string message;           ///< reason of a failure
  Eigen::MatrixXd torques;       ///< u_0 ... u_{K-1} [N m]             [torque_dim x K]
  Eigen::MatrixXd features;      ///< z_0, predicted z_1 ... z_K        [feature_dim x (K + 1)]
  Eigen::VectorXd goal_feature;  ///< z_ref                         [feature_dim]
  double cost = std::numeric_limits<double>::quiet_NaN();  ///< J; NaN after a failure
  int iterations = 0;                                      ///< sum over all initial plans
  int evaluations = 0;                                     ///< sum over all initial plans
  double solve_time = 0.0;                                 ///< wall time [s]
};

/// Minimises J(U) by BFGS (paper, Sec. 3.1) from several initial plans and keeps the best result.
/// The initial plans are the proposal of the cost if it has one, the last plan shifted by one step,
/// zero torque, and constant random torques. The substitution u = max_torque tanh(v) enforces the
/// bound; clipping after the search would bias the plan.
class Planner {
 public:
  /// @param cost  cost of plans from the current state on; must outlive the planner
  /// @throws std::invalid_argument if max_torque has a wrong number of entries
  Planner(PlanCost* cost, const MpcOptions& options);

  /// Forgets the last plan. Call it at the start of a trial.
  void clear() { last_v_.resize(0, 0); }

  /// Reports numerical trouble in the status of the plan, never by an exception.
  /// @param rng   draws the random initial plans
  /// @param stop  called before each evaluation of the cost except the first. If it returns true,
  ///              the search ends and the best plan so far is returned. Empty: the search is not
  ///              stopped
  Plan solve(std::mt19937_64* rng, const std::function<bool()>& stop = {});

 private:
  Eigen::MatrixXd unbounded(const Eigen::MatrixXd& torques) const;
  Eigen::MatrixXd startOf(int start, std::mt19937_64* rng) const;

  MpcOptions options_;
  PlanCost& cost_;
  Eigen::VectorXd max_torque_;  // of each motor [N m]
  Eigen::MatrixXd last_v_;      // v of the last plan; empty: there is none
};

}  // namespace ddm
