// Checks that a plant keeps the rules that its users rely on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// Calls every function of the plant and moves it for a few steps; afterwards it is back at its
/// start.
/// @param plant  freshly made from `options` and `camera`
/// @param twin   another one made from the same: it must do the same
/// @throws std::invalid_argument naming options.type, with each broken rule and the value
void requireSound(Plant* plant, Plant* twin, const PlantOptions& options,
                  const CameraOptions& camera);

}  // namespace ddm
