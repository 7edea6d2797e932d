// Random streams of an experiment: one per role, so that one role's draws never shift another's.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

namespace ddm {

/// Which run of an experiment this is. Fixes every random draw made in it.
struct TrialId {
  std::uint64_t seed = 0;   ///< seed of the experiment
  std::uint32_t trial = 0;  ///< number of the trial, 0 is the random one
  bool evaluation = false;  ///< the greedy run after the trial
};

/// What a stream is for. The numbers are part of what a seed means: never change them.
enum class StreamRole : std::uint32_t {
  kStart = 1,           ///< start states
  kInitialisation = 2,  ///< initial parameters of a model
  kExploration = 3,     ///< random torques, and when
  kPlannerStarts = 4,   ///< initial plans
  kMeasurement = 5,     ///< noise of PILCO's measurements
  kPolicySearch = 6,    ///< PILCO's initial policy
  kCamera = 7,          ///< brightness and lost frames
  kNoise = 8,           ///< of pixels
  kGoalNoise = 9,       ///< of the goal image's pixels
  kClutter = 10,        ///< background
  kGoal = 11,           ///< goals
  kScene = 12           ///< nuisances in the scene: camera, colours, lights
};

/// An engine fixed by run and role. (Distributions are fixed for a given libstdc++ only.)
inline std::mt19937_64 randomStream(const TrialId& id, StreamRole role) {
  std::seed_seq sequence{static_cast<std::uint32_t>(id.seed),
                         static_cast<std::uint32_t>(id.seed >> 32), id.trial,
                         id.evaluation ? 1U : 0U, static_cast<std::uint32_t>(role)};
  return std::mt19937_64(sequence);
}

}  // namespace ddm
