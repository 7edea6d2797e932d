// A policy that PILCO has learned, acting on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/policy.h>
#include <ddm_pilco/squashed_policy.h>
#include <ddm_pilco/trigonometric.h>

#include <memory>
#include <vector>

#include "observation.h"

namespace ddm {

/// u = policy(features of x)
class PilcoPolicy : public Policy {
 public:
  /// @param angles  entries of x that are angles
  PilcoPolicy(std::shared_ptr<Observation> observation,
              std::shared_ptr<pilco::SquashedPolicy> policy, const std::vector<int>& angles);

  void startTrial(const TrialId& id) override { observation_->startTrial(id); }
  void observe(const Grey& grey) override { x_ = observation_->observe(grey); }
  /// 0 where the policy's torque is not finite.
  Answer answer() override;
  void apply(const Eigen::VectorXd& /*u*/) override {}

 private:
  std::shared_ptr<Observation> observation_;
  std::shared_ptr<pilco::SquashedPolicy> policy_;
  pilco::Augmentation features_;
  Eigen::VectorXd x_;
};

}  // namespace ddm
