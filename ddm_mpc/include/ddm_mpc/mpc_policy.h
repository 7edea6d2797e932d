// Receding-horizon policy in feature space: the paper's MPC on images.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/ddm.h>
#include <ddm_model/history.h>

#include <memory>
#include <random>

#include "ddm_mpc/ddm_plan_cost.h"
#include "ddm_mpc/mpc_options.h"
#include "ddm_mpc/planner.h"
#include "ddm_mpc/policy.h"

namespace ddm {

/// Encodes each image, keeps the state x, and plans towards the model's goal feature (paper,
/// Sec. 3.1).
class MpcPolicy : public Policy {
 public:
  /// @throws std::invalid_argument if the model has no goal image, or max_torque exceeds the
  /// model's
  MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options);

  void startTrial(const TrialId& id) override;
  void observe(const Grey& grey) override;
  Plan plan() override;
  void apply(const Eigen::VectorXd& u) override;

 private:
  std::shared_ptr<const Ddm> model_;
  History x_;
  DdmPlanCost cost_;
  Planner planner_;
  std::mt19937_64 rng_;
};

}  // namespace ddm
