// Evaluator: ground truth of a greedy run, or its features -> success and error, for every driver.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_sim/plant.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "configuration.h"
#include "driver.h"

namespace ddm {

/// So many of the last images must be at the goal, or all where a run has fewer. The paper does not
/// give a number; 3 to 10 images reproduce the curve of its PILCO baseline.
constexpr int kSettledSteps = 10;        // `success`
constexpr int kSettledStepsStrict = 25;  // `success_strict`

/// What a greedy run came to.
struct Evaluation {
  bool known = false;           ///< false: nothing to judge by
  bool success = false;         ///< the last kSettledSteps images within the tolerance
  bool success_strict = false;  ///< the last kSettledStepsStrict images within it
  /// Plant::goalError() at the last image; empty without ground truth.
  std::optional<double> final_error;
  /// Sum of Plant::stepReward() over as many steps as there are images, from the first image on:
  /// those between two images count whether the camera showed them or not, and a run that took
  /// longer because images were lost earns no more for it. Empty without ground truth, or if the
  /// plant has none.
  std::optional<double> total_reward;
};

/// One row of trials.csv: the model trained on `frames` samples and its greedy evaluation.
struct TrialRow {
  int seed = 0;
  int trial = 0;
  std::uint32_t frames = 0;
  Evaluation evaluation;
  std::optional<double> v_r;  ///< empty: the method has none
  std::optional<double> v_p;
  double train_s = 0.0;
  std::uint32_t train_evaluations = 0;
  double plan_ms_median = 0.0;
  double plan_ms_p99 = 0.0;
  std::string version = "?";  ///< of the code that produced the row; "?": not known
};

/// @param plant    with the goal of this run, see Plant::setGoal()
/// @param states   the plant's state at each image; empty: no ground truth
/// @param torques  one for each image
/// @param times    of the images [s], each torque acts until the next one; empty: none was lost
/// @throws std::range_error with plant, image and value if an error or reward is not finite
Evaluation evaluate(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
                    const std::vector<Eigen::VectorXd>& torques,
                    const std::vector<double>& times = {});

/// The same by the features that the policy saw, where nobody tells the true state.
/// @param goal_distances  of each image, see Policy::goalDistance(); empty: nothing is known
Evaluation evaluateFeatures(const std::vector<double>& goal_distances,
                            const EvaluationOptions& options);

/// A run of a trial as the configuration has it, but greedy and not recorded. An evaluation is as
/// long as the plant says, or else as a trial.
/// @param evaluation  the greedy run after the trial
TrialRequest requestFor(const Configuration& configuration, int trial, bool evaluation);

/// The columns of a row of trials.csv that follow from the evaluation; the others keep their defaults.
/// @param plant  its goal is set to that of the evaluation
TrialRow rowOf(const TrialId& id, const TrialOutcome& greedy, const EvaluationOptions& options,
               Plant* plant);

/// Wilson's 95 % interval: the rates p that so many successes in n runs do not speak against.
///
///   |successes / n - p| <= 1.96 sqrt(p (1 - p) / n),   solved for p
///
/// @return low and high, within [0, 1]
std::pair<double, double> wilsonInterval(int successes, int n);

/// The value that a fraction q of all values does not exceed, by nearest rank; 0 if there are none.
double quantile(std::vector<double> values, double q);

}  // namespace ddm
