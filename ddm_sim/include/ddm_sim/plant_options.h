// What the blocks of all plants have in common. One struct = one YAML block.
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

/// The keys of the block `plant:` that every plant has. A list has a number for each motor or each
/// component of the state; a list of one number holds for all of them.
struct PlantOptions {
  std::string type;                        ///< which plant; PACKAGE/CLASS is a plugin
  std::vector<double> max_torque = {6.0};  ///< bound on each |u| [the plant's unit]
  double dt = 0.2;                         ///< time step, u is held constant over it [s]
  std::vector<double> start_std = {0.1};   ///< standard deviation of each component of the start
  int picture_size = 51;                   ///< width and height of the picture [pixels]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("type", type);
    visitor("max_torque", max_torque);
    visitor("dt", dt);
    visitor("start_std", start_std);
    visitor("picture_size", picture_size);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
    OptionChecks plant("plant");
    const auto each = [&plant](const std::vector<double>& numbers, const char* key,
                               const char* rule, bool (*ok)(double)) {
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
};

/// A number for each of `count` components.
/// @param name  of the option, for the message
/// @throws std::invalid_argument if there is neither one number nor one for each
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
