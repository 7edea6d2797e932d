// Computes the success and the error of a greedy evaluation from true states or from features.
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

/// Number of last images that must be within the tolerance (all images if an episode has fewer).
/// The paper gives no number; 3 to 10 images reproduce the curve of its PILCO baseline.
constexpr int kSettledSteps = 10;        // `success`
constexpr int kSettledStepsStrict = 25;  // `success_strict`

/// Result of a greedy evaluation.
struct Evaluation {
  bool known = false;           ///< false without ground truth and without goal distances
  bool success = false;         ///< the last kSettledSteps images are within the tolerance
  bool success_strict = false;  ///< the last kSettledStepsStrict images are within the tolerance
  /// Plant::goalError() at the last image; empty without ground truth.
  std::optional<double> final_error;
  /// Sum of Plant::stepReward() over N time steps from the first of N images on. Steps whose image
  /// was lost count too, so that an evaluation with lost images, which takes longer, earns no extra
  /// reward. Empty without ground truth or if the plant has no reward.
  std::optional<double> total_reward;
};

/// One row of trials.csv: the model trained on `frames` samples and its greedy evaluation.
struct TrialRow {
  int seed = 0;
  int trial = 0;
  std::uint32_t frames = 0;
  Evaluation evaluation;
  std::optional<double> v_r;  ///< V_R [grey^2]; empty if the method has no auto-encoder
  std::optional<double> v_p;  ///< V_P [grey^2]; empty if the method has no such error
  double train_s = 0.0;       ///< wall time of the training [s]
  std::uint32_t train_evaluations = 0;
  double plan_ms_median = 0.0;
  double plan_ms_p99 = 0.0;
  std::string version = "?";  ///< version of the code that wrote the row; "?" if it is unknown
};

/// Judges an evaluation with N images by its true states.
/// @param plant    plant whose goal is that of the evaluation, see Plant::setGoal()
/// @param states   N true states of the plant; empty without ground truth
/// @param torques  N torques [N m]
/// @param times    N stamps of the images [s]; torque k acts from times[k] to times[k + 1]. Empty
///                 if no image was lost
/// @throws std::range_error naming plant, image and value if an error or reward is not finite
Evaluation evaluate(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
                    const std::vector<Eigen::VectorXd>& torques,
                    const std::vector<double>& times = {});

/// Judges an evaluation by the features of its images, for plants without ground truth.
/// @param goal_distances  Policy::goalDistance() of each image; if empty, the result is unknown
Evaluation evaluateFeatures(const std::vector<double>& goal_distances,
                            const EvaluationOptions& options);

/// The request for one episode: a recorded trial or its greedy evaluation (epsilon = 0, no bag).
/// The caller sets epsilon and bag of a trial. The plant may define the length of an evaluation;
/// otherwise the evaluation is as long as an episode of a trial.
/// @param evaluation  true for the greedy evaluation after the trial
TrialRequest requestFor(const Configuration& configuration, int trial, bool evaluation);

/// Fills the columns of trials.csv that follow from an evaluation. All other columns keep their
/// default values.
/// @param plant  changed: its goal becomes that of the evaluation
TrialRow rowOf(const TrialId& id, const TrialOutcome& greedy, const EvaluationOptions& options,
               Plant* plant);

/// Wilson's 95 % interval: all success rates p that are consistent with the observed successes.
///
///   |successes / n - p| <= 1.96 sqrt(p (1 - p) / n),   solved for p
///
/// @return lower and upper end, within [0, 1]
std::pair<double, double> wilsonInterval(int successes, int n);

/// The smallest value that at least a fraction q of all values does not exceed (nearest rank); 0 if
/// there are no values.
double quantile(std::vector<double> values, double q);

}  // namespace ddm
