// Makes the plant that a configuration names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// Makes plants of one kind, which another package brings: all of their options but the camera.
class PlantMaker {
 public:
  virtual ~PlantMaker() = default;

  /// @throws std::invalid_argument if plant and camera do not fit together
  virtual std::unique_ptr<Plant> make(const CameraOptions& camera) const = 0;
};

/// The plant `plant.type`, in the middle of its start states; that of `plant.maker` if there is
/// one. Each plant is moved for a few steps, so that one that breaks the rules of class Plant is
/// refused here and not in the middle of a run.
/// @throws std::invalid_argument with all problems of both blocks, an unknown type among them, or
///         with the type and all rules that its plant breaks
std::unique_ptr<Plant> makePlant(const PlantOptions& plant, const CameraOptions& camera);

}  // namespace ddm
