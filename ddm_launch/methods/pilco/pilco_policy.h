// The policy that PILCO searches, on an observation, and where its first search starts.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_mpc/policy.h>
#include <ddm_pilco/squashed_policy.h>
#include <ddm_pilco/trigonometric.h>

#include <memory>
#include <random>
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

/// Parameters of the RBF policy of PILCO's first trial: centres drawn from the features of the
/// start distribution, which is taken as Gaussian, small random targets, length-scales of the task.
/// @param features  of the task's state
Eigen::VectorXd drawPolicyStart(const PilcoTask& task, const pilco::Augmentation& features,
                                int num_centres, int torque_dim, std::mt19937_64* rng);

}  // namespace ddm
