// The paper's moving tile: a square that is pushed about in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/moving_tile.h"

#include <cmath>
#include <sstream>

namespace ddm {
namespace {

/// `plant` unchanged, so that the checks precede the first use of its values.
const PlantOptions& checked(const PlantOptions& plant, const CameraOptions& camera) {
  std::vector<std::string> problems = problemsOf(plant, camera);
  if (plant.tile_width >= camera.size) {  // neither block can see this by itself
    std::ostringstream problem;
    problem << "plant/tile_width must be smaller than camera/size (" << camera.size
            << " pixels), got " << plant.tile_width;
    problems.push_back(problem.str());
  }
  requireNone(problems);
  return plant;
}

/// `position` folded back into [lowest, highest] at both ends: a triangle wave.
double reflected(double position, double lowest, double highest) {
  return lowest + std::abs(std::remainder(position - lowest, 2 * (highest - lowest)));
}

}  // namespace

MovingTile::MovingTile(const PlantOptions& plant, const CameraOptions& camera)
    : Plant(Eigen::Vector2d::Constant(camera.size / 2.0), 2, checked(plant, camera).dt,
            plant.max_torque, plant.start_std),
      lowest_(plant.tile_width / 2),
      highest_(camera.size - plant.tile_width / 2),
      renderer_(camera.size, plant.tile_width, plant.tile_softness) {}

Eigen::VectorXd MovingTile::goalState() const {
  const Eigen::Vector2d goal(0.75 * imageSize(), 0.25 * imageSize());
  return goal.cwiseMax(lowest_).cwiseMin(highest_);
}

Eigen::VectorXd MovingTile::advance(const Eigen::VectorXd& state,
                                    const Eigen::VectorXd& torque) const {
  return (state + torque).unaryExpr([this](double position) {
    return reflected(position, lowest_, highest_);
  });
}

double MovingTile::distanceToGoal(const Eigen::VectorXd& state) const {
  return (state - goalState()).stableNorm();
}

std::vector<std::uint8_t> MovingTile::draw(const Eigen::VectorXd& state) const {
  return renderer_.render(state);
}

}  // namespace ddm
