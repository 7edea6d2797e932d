// Random streams of the policy: one per role, so that one role's draws never shift another's.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

#include "ddm_mpc/policy.h"

namespace ddm {

/// What a stream is for. The numbers are part of what a seed means: never change them. 1 and those
/// from 7 on are ddm_sim's, 2 is ddm_model's.
enum class StreamRole : std::uint32_t {
  kExploration = 3,
  kPlannerStarts = 4,
  kMeasurement = 5,
  kPolicySearch = 6
};

/// @return an engine fixed by run and role
inline std::mt19937_64 randomStream(const TrialId& id, StreamRole role) {
  std::seed_seq sequence{static_cast<std::uint32_t>(id.seed),
                         static_cast<std::uint32_t>(id.seed >> 32), id.trial,
                         id.evaluation ? 1U : 0U, static_cast<std::uint32_t>(role)};
  return std::mt19937_64(sequence);
}

}  // namespace ddm
