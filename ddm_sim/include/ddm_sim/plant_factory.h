// Makes plants, and refuses those that describe themselves in a way that nothing can rely on.
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
};

/// Whether a name can head a column of CSV files: neither blanks nor commas nor quotes, ASCII alone.
bool usableName(const std::string& name);

/// A plant in the middle of its start states. Its PlantInfo must have
///
///   - as many names, limits, starts and goals as components, 1 to 1000 of each, all finite; names
///     differ and have neither blanks nor commas nor quotes, since they head columns
///   - no more joints than components of the state, and at least one
///   - dt > 0, limits > 0, start_std >= 0, tolerance > 0, and an error_unit
///
/// Class Plant checks what the plant returns while it runs. test/every_plant_test.cpp tests all other
/// rules, also of a plant of another package.
/// @throws std::invalid_argument with the problems of the options, or with the type and all rules
///         that its plant breaks
std::unique_ptr<Plant> makePlant(const PlantMaker& maker);

}  // namespace ddm
