// Makes the plant that a configuration names.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"

namespace ddm {

/// The plant `plant.type`, at rest in the middle of its start states.
/// @throws std::invalid_argument with all problems of both blocks, an unknown type among them
std::unique_ptr<Plant> makePlant(const PlantOptions& plant, const CameraOptions& camera);

}  // namespace ddm
