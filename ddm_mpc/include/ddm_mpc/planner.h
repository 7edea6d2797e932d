// Planner: the torques u_0 ... u_{K-1} that minimise the cost of a plan, by BFGS from several initial plans.
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

/// Cost of the torques u_0 ... u_{K-1} from a current state on, which the implementation holds. With
/// `mpc/cost: distance`
///
///   J(U) = sum_{k=1}^{K} |z_k - z_ref|^2 + lambda |u_{k-1}|^2
///
/// and DdmPlanCost has another. Implementations differ in whose predictions z_k are: eq. (7) of the paper plans with a known
/// model of the state, eq. (9) in feature space. Deviation: the paper's sum runs over z_0 ...
/// z_{K-1}, in which z_0 is a constant and u_{K-1} acts on nothing; here it runs over the K
/// features that the K torques bring about.
class PlanCost {
 public:
  virtual ~PlanCost() = default;

  /// @param U    torques [N m]                            [torqueDim() x horizon()]
  /// @param d_U  out: dJ/dU; null: not wanted [1/(N m)]   [torqueDim() x horizon()]
  /// @return     J(U)
  virtual double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) = 0;

  /// An initial plan from which a search is worthwhile; empty if there is none [N m]
  virtual std::optional<Eigen::MatrixXd> proposal() { return std::nullopt; }

  /// z_0 and the features predicted in the last evaluate()  [feature_dim x (K + 1)]
  virtual Eigen::MatrixXd predictedFeatures() const = 0;

  virtual Eigen::VectorXd goalFeature() const = 0;  ///< z_ref  [feature_dim]
  virtual int horizon() const = 0;                  ///< K, steps
  virtual int torqueDim() const = 0;
};

/// How the search for a plan ended. The numbers are those of ddm_msgs/Plan.
enum class PlanStatus {
  kConverged = 0,       ///< the solver met its tolerance
  kIterationLimit = 1,  ///< usable; the search ended before that
  kFailed = 2,          ///< no usable plan
  kTimeLimit = 3,       ///< usable; the search was stopped, this is the best plan it had found
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

/// Minimises J(U) by BFGS (paper, Sec. 3.1) from several initial plans and keeps the best result. The
/// initial plans are the proposal of the cost, if it has one, the last plan moved on by one step, no
/// torque, and constant torques drawn at random. The bound holds by construction, u = max_torque tanh(v),
/// because clipping afterwards would bias the plan.
class Planner {
 public:
  /// @param cost  of plans from the current state on; outlives the planner
  /// @throws std::invalid_argument if max_torque is for another number of motors
  Planner(PlanCost* cost, const MpcOptions& options);

  /// Forgets the last plan: the next problem is the first of a trial.
  void clear() { last_v_.resize(0, 0); }

  /// Numerical trouble is reported by the status of the plan, never by an exception.
  /// @param rng   draws the random initial plans
  /// @param stop  called before each evaluation of the cost but the first. If it returns true, the whole
  ///              search ends, and the best plan evaluated so far is returned. Empty: never
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
