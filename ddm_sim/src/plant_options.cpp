// What the blocks of all plants have in common: what values are valid.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_options.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace ddm {

std::vector<std::string> PlantOptions::problems() const {
  OptionChecks plant("plant");
  const auto each = [&plant](const std::vector<double>& numbers, const char* key, const char* rule,
                             bool (*ok)(double)) {
    plant.require(!numbers.empty(), key, "have at least one number", "none");
    for (const double number : numbers) plant.require(ok(number), key, rule, number);
  };
  each(max_torque, "max_torque", "be > 0 and finite", isPositive);
  // Stamps count whole nanoseconds, and no camera can keep a step below a millisecond.
  plant.requireWithin("dt", dt, 1e-3, 10.0);
  each(start_std, "start_std", "be >= 0 and finite", isNotNegative);
  plant.requireWithin("picture_size", picture_size, 4, 1024);
  return plant.problems();
}

Eigen::VectorXd forEach(const std::vector<double>& numbers, int count, const std::string& name) {
  if (numbers.size() == 1) return Eigen::VectorXd::Constant(count, numbers.front());
  if (static_cast<int>(numbers.size()) == count) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), count);
  }
  throw std::invalid_argument(name + " must be one number or a list of " + std::to_string(count) +
                              ", got " + std::to_string(numbers.size()));
}

}  // namespace ddm
