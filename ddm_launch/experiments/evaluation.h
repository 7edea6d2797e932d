// Evaluator: ground truth of a greedy run -> success and error. The same for every driver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/plant.h>

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "experiment_options.h"

namespace ddm {

/// What a greedy run came to.
struct Evaluation {
  bool known = false;            ///< false: no ground truth, or no angle to measure in degrees
  bool success = false;          ///< the last settled_steps frames within the tolerance
  bool success_strict = false;   ///< the last settled_steps_strict frames within it
  double final_error_deg = 0.0;  ///< distance to the goal at the last frame [deg]
};

/// @param states  the plant's state at each frame, see Plant::state(); empty: no ground truth
/// @throws std::invalid_argument if there are fewer frames than settled_steps_strict
Evaluation evaluate(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
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
