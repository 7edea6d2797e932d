// Parameters of an experiment: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "experiment_options.h"

#include <ddm_msgs/option_checks.h>

#include <stdexcept>

namespace ddm {

std::vector<std::string> ExperimentOptions::problems() const {
  OptionChecks checks("experiment");
  checks.require(seed >= 0, "seed", "be >= 0", seed);
  checks.require(trials >= 0 && trials <= 999, "trials", "lie in [0, 999]", trials);
  checks.requirePositive("timeout", timeout);
  return checks.problems();
}

std::vector<std::string> TrialOptions::problems() const {
  OptionChecks checks("trial");
  checks.require(num_steps >= 1 && num_steps <= 1000000, "num_steps", "lie in [1, 1000000]",
                 num_steps);
  checks.require(episodes >= 1 && episodes <= 1000, "episodes", "lie in [1, 1000]", episodes);
  return checks.problems();
}

std::vector<std::string> EvaluationOptions::problems() const {
  OptionChecks checks("evaluation");
  checks.require(num_steps >= 0 && num_steps <= 1000000, "num_steps", "lie in [0, 1000000]",
                 num_steps);
  checks.requireNotNegative("tolerance", tolerance);
  checks.require(settled_steps >= 1, "settled_steps", "be >= 1", settled_steps);
  checks.require(settled_steps_strict >= settled_steps, "settled_steps_strict",
                 "be >= evaluation/settled_steps", settled_steps_strict);
  checks.requireNotNegative("goal_distance", goal_distance);
  return checks.problems();
}

void EvaluationOptions::complete(const PlantInfo& plant) {
  if (!error_unit.empty() && error_unit != plant.error_unit) {
    throw std::invalid_argument("evaluation/error_unit must be that of the plant, " +
                                plant.error_unit + ", got " + error_unit +
                                ": leave it out, and give evaluation/tolerance in that unit");
  }
  error_unit = plant.error_unit;
  if (tolerance == 0.0) tolerance = plant.tolerance;
  if (num_steps == 0) num_steps = plant.evaluation_steps;
}

}  // namespace ddm
