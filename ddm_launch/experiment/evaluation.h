// Evaluator: ground truth of a greedy run, or its features -> success and error, for every driver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/plant.h>

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "experiment_options.h"

namespace ddm {

/// What a greedy run came to.
struct Evaluation {
  bool known = false;           ///< false: nothing to judge by
  bool success = false;         ///< the last settled_steps frames within the tolerance
  bool success_strict = false;  ///< the last settled_steps_strict frames within it
  /// Plant::goalError() at the last frame; empty without ground truth.
  std::optional<double> final_error;
  /// Sum of Plant::stepReward() over as many steps as there are frames, from the first frame on:
  /// those between two frames count whether the camera showed them or not, and a run that took
  /// longer because frames were lost earns no more for it. Empty without ground truth, or if the
  /// plant has none.
  std::optional<double> total_reward;
};

/// @param plant    with the goal of this run, see Plant::setGoal()
/// @param states   the plant's state at each frame; empty: no ground truth
/// @param torques  one for each frame
/// @param options  completed by those of the plant
/// @param times    of the frames [s], each torque acts until the next one; empty: none was lost
/// @throws std::invalid_argument if there are fewer frames than settled_steps_strict
/// @throws std::range_error with plant, frame and value if an error or reward is not finite
Evaluation evaluate(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
                    const std::vector<Eigen::VectorXd>& torques, const EvaluationOptions& options,
                    const std::vector<double>& times = {});

/// The same by the features that the policy saw, where nobody tells the true state.
/// @param goal_distances  of each frame, see Policy::goalDistance(); empty: nothing is known
/// @throws std::invalid_argument as above
Evaluation evaluateFeatures(const std::vector<double>& goal_distances,
                            const EvaluationOptions& options);

/// Wilson's 95 % interval: the rates p that so many successes in n runs do not speak against.
///
///   |successes / n - p| <= 1.96 sqrt(p (1 - p) / n),   solved for p
///
/// @return low and high, within [0, 1]
std::pair<double, double> wilsonInterval(int successes, int n);

/// The value that a fraction q of all values does not exceed, by nearest rank; 0 if there are none.
double quantile(std::vector<double> values, double q);

}  // namespace ddm
