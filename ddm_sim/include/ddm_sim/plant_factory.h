// Makes plants, and refuses those that break the rules of class Plant.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "ddm_sim/plant.h"

namespace ddm {

/// Makes plants of one kind, with the options that it holds.
class PlantMaker {
 public:
  virtual ~PlantMaker() = default;

  virtual std::string type() const = 0;  ///< `plant/type`, for messages

  /// @throws std::invalid_argument if the options do not fit together
  virtual std::unique_ptr<Plant> make() const = 0;

  /// False where the first picture is costly: makePlant() then looks at none of them.
  virtual bool drawsCheaply() const { return true; }
};

/// Whether a name can head a column of CSV files: neither blanks nor commas nor quotes, ASCII alone.
bool usableName(const std::string& name);

/// A plant in the middle of its start states. It is moved for a few steps beside a second one, so
/// that a plant that breaks the rules of class Plant is refused here and not in the middle of a
/// run. The rules:
///
///   - as many names, limits, starts and goals as components, 1 to 1000 of each, all finite; names
///     differ and have neither blanks nor commas nor quotes, since they head columns
///   - no more joints than components of the state, and at least one
///   - dt > 0, limits > 0, start_std >= 0, tolerance > 0, and an error_unit
///   - the error is finite and >= 0 everywhere, and within the tolerance at the goal; so is a drawn
///     goal, and a reward is finite
///   - pictures have one size, and cover at least as much as they are bright
///   - visiblePosition() has always as many finite coordinates
///   - the same start and torques give the same states and pictures, each time and in each plant
///     from one maker
/// @throws std::invalid_argument with the problems of the options, or with the type and all rules
///         that its plant breaks
std::unique_ptr<Plant> makePlant(const PlantMaker& maker);

}  // namespace ddm
