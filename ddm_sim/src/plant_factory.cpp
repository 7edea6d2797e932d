// Makes the plant that a configuration names.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_factory.h"

#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"

namespace ddm {

std::unique_ptr<Plant> makePlant(const PlantOptions& plant, const CameraOptions& camera) {
  if (plant.maker != nullptr) return plant.maker->make(camera);
  if (plant.type == "moving_tile") return std::make_unique<MovingTile>(plant, camera);
  // An unknown type is one of the problems that the constructor reports together with the others.
  return std::make_unique<Pendulum>(plant, camera);
}

}  // namespace ddm
