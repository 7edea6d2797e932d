// Computes the success and the error of a greedy evaluation from true states or from features.
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation.h"

#include <ddm_common/param_value.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

/// Checks whether the last images are all within the tolerance.
/// @param errors     distance to the goal at each image, in any unit
/// @param tolerance  largest distance that counts as success, in the same unit
Evaluation settled(const std::vector<double>& errors, double tolerance) {
  const auto num_images = static_cast<int>(errors.size());
  int num_settled = 0;
  for (auto error = errors.rbegin(); error != errors.rend() && *error <= tolerance; ++error) {
    ++num_settled;
  }
  Evaluation evaluation;
  evaluation.known = true;
  evaluation.success = num_settled >= std::min(kSettledSteps, num_images);
  evaluation.success_strict = num_settled >= std::min(kSettledStepsStrict, num_images);
  return evaluation;
}

/// @return `value`
/// @throws std::range_error naming plant and image if the value is not finite
double requireFinite(double value, const std::string& what, const Plant& plant, std::size_t image) {
  if (std::isfinite(value)) return value;
  throw std::range_error("plant " + plant.info().type + ": the " + what + " of image " +
                         std::to_string(image) + " must be finite, got " + formatDouble(value) +
                         ": correct the plant; the same command resumes with this evaluation");
}

/// Number of time steps between an image and the next one; 1 after the last image.
int stepsAfter(std::size_t image, const std::vector<double>& times, double dt) {
  if (image + 1 >= times.size()) return 1;
  return std::max(1, static_cast<int>(std::lround((times[image + 1] - times[image]) / dt)));
}

/// @return see Evaluation::total_reward
std::optional<double> totalReward(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
                                  const std::vector<Eigen::VectorXd>& torques,
                                  const std::vector<double>& times) {
  std::optional<double> sum;
  auto steps_left = static_cast<int>(states.size());
  for (std::size_t t = 0; t < states.size() && t < torques.size() && steps_left > 0; ++t) {
    const int num_steps = std::min(stepsAfter(t, times, plant.info().dt), steps_left);
    const std::optional<double> reward = plant.stepReward(states[t], torques[t], num_steps);
    if (reward) sum = sum.value_or(0.0) + requireFinite(*reward, "reward", plant, t);
    steps_left -= num_steps;
  }
  return sum;
}

}  // namespace

Evaluation evaluate(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
                    const std::vector<Eigen::VectorXd>& torques, const std::vector<double>& times) {
  if (states.empty()) return Evaluation();
  std::vector<double> errors;
  for (const Eigen::VectorXd& state : states) {
    errors.push_back(requireFinite(plant.goalError(state), "error", plant, errors.size()));
  }
  Evaluation evaluation = settled(errors, plant.info().tolerance);
  evaluation.final_error = errors.back();
  evaluation.total_reward = totalReward(plant, states, torques, times);
  return evaluation;
}

Evaluation evaluateFeatures(const std::vector<double>& goal_distances,
                            const EvaluationOptions& options) {
  if (goal_distances.empty() || options.goal_distance == 0.0) return Evaluation();
  return settled(goal_distances, options.goal_distance);
}

TrialRequest requestFor(const Configuration& configuration, int trial, bool evaluation) {
  TrialRequest request;
  request.id.seed = static_cast<std::uint64_t>(configuration.experiment.seed);
  request.id.trial = static_cast<std::uint32_t>(trial);
  request.id.evaluation = evaluation;
  const int of_plant = configuration.plant_info.evaluation_steps;
  request.num_steps = evaluation && of_plant > 0 ? of_plant : configuration.trial.num_steps;
  request.hold_steps = configuration.mpc.hold_steps;
  return request;
}

TrialRow rowOf(const TrialId& id, const TrialOutcome& greedy, const EvaluationOptions& options,
               Plant* plant) {
  TrialRow row;
  row.seed = static_cast<int>(id.seed);
  row.trial = static_cast<int>(id.trial);
  plant->setGoal(goalOf(*plant, id));
  row.evaluation = greedy.states.empty()
                       ? evaluateFeatures(greedy.goal_distances, options)
                       : evaluate(*plant, greedy.states, greedy.torques, greedy.times);
  row.plan_ms_median = 1e3 * quantile(greedy.solve_times, 0.5);
  row.plan_ms_p99 = 1e3 * quantile(greedy.solve_times, 0.99);
  return row;
}

std::pair<double, double> wilsonInterval(int successes, int n) {
  constexpr double kZ = 1.959963984540054;  // 97.5 % quantile of N(0, 1)
  const double rate = static_cast<double>(successes) / n;
  const double shrink = 1.0 / (1.0 + kZ * kZ / n);
  const double centre = shrink * (rate + kZ * kZ / (2.0 * n));
  const double half = shrink * kZ * std::sqrt(rate * (1.0 - rate) / n + kZ * kZ / (4.0 * n * n));
  // The ends are exactly 0 and 1 for no and for only successes. The formulas would round.
  return {successes == 0 ? 0.0 : centre - half, successes == n ? 1.0 : centre + half};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(q * static_cast<double>(values.size()));
  const auto index = static_cast<size_t>(std::max(1.0, rank)) - 1;
  return values[std::min(index, values.size() - 1)];
}

}  // namespace ddm
