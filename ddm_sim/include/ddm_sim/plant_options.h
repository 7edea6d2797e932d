// Parameters that the YAML blocks of all plants have in common.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <Eigen/Core>
#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace ddm {

/// The keys that every plant has in its block `plant:`. A list has one number for each motor or for
/// each component of the state; a list with one number applies that number to all of them.
struct PlantOptions {
  std::string type;                        ///< type of the plant; PACKAGE/CLASS names a plugin
  std::vector<double> max_torque = {6.0};  ///< bound on each |u| [unit of the plant]
  double dt = 0.2;                         ///< time step, over which u is constant [s]
  /// Standard deviation of each component of the initial state.
  std::vector<double> start_std = {0.1};
  int image_size = 51;  ///< width and height of the rendered image [pixels]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("type", type);
    visitor("max_torque", max_torque);
    visitor("dt", dt);
    visitor("start_std", start_std);
    visitor("image_size", image_size);
  }

  /// Describes each invalid value and the rule that it breaks. Empty if all values are valid.
  std::vector<std::string> problems() const {
    OptionChecks plant("plant");
    const auto each = [&plant](const std::vector<double>& numbers, const char* key,
                               const char* rule, bool (*ok)(double)) {
      plant.require(!numbers.empty(), key, "have at least one number", "none");
      for (const double number : numbers) plant.require(ok(number), key, rule, number);
    };
    each(max_torque, "max_torque", "be > 0 and finite", isPositive);
    // Stamps count whole nanoseconds, and no camera delivers images at intervals below a
    // millisecond.
    plant.requireWithin("dt", dt, 1e-3, 10.0);
    each(start_std, "start_std", "be >= 0 and finite", isNotNegative);
    plant.requireWithin("image_size", image_size, 4, 1024);
    return plant.problems();
  }
};

/// Expands a list to one number for each of `count` components.
/// @param name  name of the option, for the message
/// @throws std::invalid_argument if the list has neither one number nor `count` numbers
inline Eigen::VectorXd forEach(const std::vector<double>& numbers, int count,
                               const std::string& name) {
  if (numbers.size() == 1) return Eigen::VectorXd::Constant(count, numbers.front());
  if (static_cast<int>(numbers.size()) == count) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), count);
  }
  throw std::invalid_argument(name + " must be one number or a list of " + std::to_string(count) +
                              ", got " + std::to_string(numbers.size()));
}

}  // namespace ddm
