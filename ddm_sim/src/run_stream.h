// Random streams of the simulator: one per role, so that one role's draws never shift another's.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

namespace ddm {

/// What a stream is for. The numbers are part of what a seed means: never change them. 2 is
/// ddm_model's, 3 to 6 are ddm_mpc's.
enum class SimRole : std::uint32_t {
  kStart = 1,
  kCamera = 7,  ///< brightness and lost frames
  kNoise = 8,
  kGoalNoise = 9,
  kClutter = 10,
  kGoal = 11
};

/// @return an engine fixed by run and role
inline std::mt19937_64 runStream(std::uint64_t seed, std::uint32_t trial, bool evaluation,
                                 SimRole role) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                         trial, evaluation ? 1U : 0U, static_cast<std::uint32_t>(role)};
  return std::mt19937_64(sequence);
}

}  // namespace ddm
