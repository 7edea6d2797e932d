// A planner together with the cost that it plans by, for tests.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_mpc/ddm_plan_cost.h"
#include "ddm_mpc/planner.h"

namespace ddm {

/// Plans with a deep dynamical model from any state to any goal, as MpcPolicy does.
class ModelPlanner {
 public:
  ModelPlanner(const Ddm& model, const MpcOptions& options)
      : cost_(model, options.horizon, options.control_weight), planner_(&cost_, options) {}

  Plan solve(const History& x, const Eigen::VectorXd& goal_feature, std::mt19937_64* rng,
             const std::function<bool()>& stop = {}) {
    cost_.setProblem(x, goal_feature);
    return planner_.solve(rng, stop);
  }
  void setHorizon(int horizon) { cost_.setHorizon(horizon); }
  void clear() { planner_.clear(); }

 private:
  DdmPlanCost cost_;
  Planner planner_;
};

}  // namespace ddm
