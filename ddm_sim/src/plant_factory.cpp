// Makes the plant that a configuration names.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_factory.h"

#include "ddm_sim/moving_tile.h"
#include "ddm_sim/pendulum.h"
#include "plant_check.h"

namespace ddm {

namespace {

std::unique_ptr<Plant> construct(const PlantOptions& plant, const CameraOptions& camera) {
  if (plant.maker != nullptr) return plant.maker->make(camera);
  if (plant.type == "moving_tile") return std::make_unique<MovingTile>(plant, camera);
  // An unknown type is one of the problems that the constructor reports together with the others.
  return std::make_unique<Pendulum>(plant, camera);
}

/// Problems of what all plants have; the constructors of ours report these with their own.
std::vector<std::string> sharedProblems(const PlantOptions& plant, const CameraOptions& camera) {
  std::vector<std::string> problems = plant.PlantBasics::problems();
  for (const std::string& problem : camera.problems()) problems.push_back(problem);
  return problems;
}

}  // namespace

std::unique_ptr<Plant> makePlant(const PlantOptions& plant, const CameraOptions& camera) {
  if (plant.maker != nullptr) requireNone(sharedProblems(plant, camera));
  std::unique_ptr<Plant> made = construct(plant, camera);
  requireSound(made.get(), construct(plant, camera).get(), plant, camera);
  return made;
}

}  // namespace ddm
