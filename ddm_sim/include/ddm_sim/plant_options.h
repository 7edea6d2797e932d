// What the blocks of all plants have in common. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_msgs/option_checks.h>

#include <Eigen/Core>
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
  std::vector<std::string> problems() const;
};

/// A number for each of `count` components.
/// @param name  of the option, for the message
/// @throws std::invalid_argument if there is neither one number nor one for each
Eigen::VectorXd forEach(const std::vector<double>& numbers, int count, const std::string& name);

}  // namespace ddm
