// Random streams of an experiment: an independent one for each purpose.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

namespace ddm {

/// Identifies an episode of an experiment and determines all of its random draws.
struct TrialId {
  std::uint64_t seed = 0;  ///< seed of the experiment
  /// Number of the episode: trial * trial/episodes + episode, where trial is the number of the trial
  /// and episode the number within the trial. For an evaluation, number of the trial.
  std::uint32_t trial = 0;
  bool evaluation = false;  ///< true for the evaluation (greedy episode) that follows the trial
};

/// Purpose of a random stream. The numbers determine the draws of every seed: never change them.
enum class StreamRole : std::uint32_t {
  kStart = 1,           ///< initial states
  kInitialisation = 2,  ///< initial weights of a model
  kExploration = 3,     ///< random torques and the times at which they are used
  kPlannerStarts = 4,   ///< initial plans
  kMeasurement = 5,     ///< measurement noise of PILCO
  kPolicySearch = 6,    ///< initial policy of PILCO
  kCamera = 7,          ///< brightness and lost images
  kNoise = 8,           ///< pixel noise of the images
  kGoalNoise = 9,       ///< pixel noise of the goal image
  kClutter = 10,        ///< background pattern of the camera
  kGoal = 11,           ///< goals of episodes
  kGpSamples = 13       ///< samples that select the length scales of a Gaussian process
};

/// Returns the random engine for an episode and a purpose. The distributions of the standard
/// library are reproducible for one version of libstdc++ only.
inline std::mt19937_64 randomStream(const TrialId& id, StreamRole role) {
  std::seed_seq sequence{static_cast<std::uint32_t>(id.seed),
                         static_cast<std::uint32_t>(id.seed >> 32), id.trial,
                         id.evaluation ? 1U : 0U, static_cast<std::uint32_t>(role)};
  return std::mt19937_64(sequence);
}

}  // namespace ddm
