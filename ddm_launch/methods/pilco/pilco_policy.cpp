// A policy that PILCO has learned, acting on an observation.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco_policy.h"

#include <chrono>
#include <utility>

namespace ddm {

PilcoPolicy::PilcoPolicy(std::shared_ptr<Observation> observation,
                         std::shared_ptr<pilco::SquashedPolicy> policy,
                         const std::vector<int>& angles)
    : observation_(std::move(observation)),
      policy_(std::move(policy)),
      features_(pilco::replaceAngles(static_cast<int>(observation_->names().size()), angles)) {}

Answer PilcoPolicy::answer() {
  const auto start = std::chrono::steady_clock::now();
  Answer answer;
  answer.torque = policy_->control(features_.value(x_));
  if (!answer.torque.allFinite()) answer.torque.setZero();
  answer.solve_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return answer;
}

}  // namespace ddm
