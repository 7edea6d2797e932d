// Evaluator: ground truth of a greedy run -> success and error. The same for every driver.
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ddm {

Evaluation evaluate(const Plant& plant, const std::vector<Eigen::VectorXd>& states,
                    const EvaluationOptions& options) {
  Evaluation evaluation;
  if (states.empty() || !plant.turns()) return evaluation;
  if (static_cast<int>(states.size()) < options.settled_steps_strict) {
    throw std::invalid_argument("an evaluation needs at least " +
                                std::to_string(options.settled_steps_strict) + " frames, got " +
                                std::to_string(states.size()));
  }
  const auto error_deg = [&plant](const Eigen::VectorXd& state) {
    return plant.goalError(state) * 180.0 / 3.14159265358979323846;
  };
  int settled = 0;
  for (auto state = states.rbegin();
       state != states.rend() && error_deg(*state) <= options.tolerance_deg; ++state) {
    ++settled;
  }
  evaluation.known = true;
  evaluation.success = settled >= options.settled_steps;
  evaluation.success_strict = settled >= options.settled_steps_strict;
  evaluation.final_error_deg = error_deg(states.back());
  return evaluation;
}

std::pair<double, double> wilsonInterval(int successes, int n) {
  constexpr double kZ = 1.959963984540054;  // 97.5 % of N(0, 1) lie below
  const double rate = static_cast<double>(successes) / n;
  const double shrink = 1.0 / (1.0 + kZ * kZ / n);
  const double centre = shrink * (rate + kZ * kZ / (2.0 * n));
  const double half = shrink * kZ * std::sqrt(rate * (1.0 - rate) / n + kZ * kZ / (4.0 * n * n));
  // Exactly 0 and 1 at the ends, where rounding would leave a little.
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
