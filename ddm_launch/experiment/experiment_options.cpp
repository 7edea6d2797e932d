// Parameters of an experiment: what makes them valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "experiment_options.h"

#include <cmath>
#include <stdexcept>

namespace ddm {

std::vector<std::string> ExperimentOptions::problems() const {
  std::vector<std::string> out;
  if (seed < 0) out.push_back("experiment/seed must be >= 0, got " + std::to_string(seed));
  if (trials < 0 || trials > 999) {
    out.push_back("experiment/trials must lie in [0, 999], got " + std::to_string(trials));
  }
  if (!(timeout > 0.0 && std::isfinite(timeout))) {
    out.push_back("experiment/timeout must be > 0, got " + std::to_string(timeout));
  }
  return out;
}

std::vector<std::string> TrialOptions::problems() const {
  if (num_steps >= 1 && num_steps <= 1000000) return {};
  return {"trial/num_steps must lie in [1, 1000000], got " + std::to_string(num_steps)};
}

std::vector<std::string> EvaluationOptions::problems() const {
  std::vector<std::string> out;
  if (!(tolerance >= 0.0 && std::isfinite(tolerance))) {
    out.push_back("evaluation/tolerance must be >= 0 and finite, got " + std::to_string(tolerance));
  }
  if (settled_steps < 1) {
    out.push_back("evaluation/settled_steps must be >= 1, got " + std::to_string(settled_steps));
  }
  if (settled_steps_strict < settled_steps) {
    out.push_back("evaluation/settled_steps_strict must be >= evaluation/settled_steps, got " +
                  std::to_string(settled_steps_strict));
  }
  if (!(goal_distance >= 0.0 && std::isfinite(goal_distance))) {
    out.push_back("evaluation/goal_distance must be >= 0, got " + std::to_string(goal_distance));
  }
  return out;
}

void EvaluationOptions::complete(const PlantInfo& plant) {
  if (!error_unit.empty() && error_unit != plant.error_unit) {
    throw std::invalid_argument("evaluation/error_unit must be that of the plant, " +
                                plant.error_unit + ", got " + error_unit +
                                ": leave it out, and give evaluation/tolerance in that unit");
  }
  error_unit = plant.error_unit;
  if (tolerance == 0.0) tolerance = plant.tolerance;
}

std::vector<std::string> PredictionOptions::problems() const {
  std::vector<std::string> out;
  const auto require = [&out](bool ok, const std::string& rule, int value) {
    if (!ok) out.push_back("prediction/" + rule + ", got " + std::to_string(value));
  };
  require(training_frames >= 1 && training_frames <= 1000000,
          "training_frames must lie in [1, 1000000]", training_frames);
  require(max_steps >= 1 && max_steps <= 1000, "max_steps must lie in [1, 1000]", max_steps);
  require(held_out_frames >= 1 && held_out_frames <= 1000000,
          "held_out_frames must lie in [1, 1000000]", held_out_frames);
  return out;
}

}  // namespace ddm
