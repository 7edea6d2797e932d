// The paper's moving tile: a square that is pushed about in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/moving_tile.h"

#include <cmath>

#include "ddm_sim/option_checks.h"

namespace ddm {
namespace {

PlantInfo infoOf(const MovingTileOptions& options) {
  const double size = options.picture_size;
  const double margin = options.tile_width / 2;
  const Eigen::VectorXd goal = (Eigen::VectorXd(2) << 0.75 * size, 0.25 * size).finished();
  PlantInfo info;
  info.joints = {{"x", JointKind::kLength}, {"y", JointKind::kLength}};
  info.state_names = {"x_px", "y_px"};
  info.torque_names = {"dx_px", "dy_px"};
  info.max_torque = forEach(options.max_torque, 2, "plant/max_torque");
  info.dt = options.dt;
  info.start = Eigen::VectorXd::Constant(2, size / 2);
  info.start_std = forEach(options.start_std, 2, "plant/start_std");
  info.goal = goal.cwiseMax(margin).cwiseMin(size - margin);
  info.error_unit = "px";
  info.tolerance = 2.0;
  return info;
}

/// `position` folded back into [lowest, highest] at both ends: a triangle wave.
double reflected(double position, double lowest, double highest) {
  return lowest + std::abs(std::remainder(position - lowest, 2 * (highest - lowest)));
}

}  // namespace

std::vector<std::string> MovingTileOptions::problems() const {
  OptionChecks plant("plant");
  plant.requirePositive("tile_width", tile_width);
  plant.require(tile_width < picture_size, "tile_width",
                "be smaller than plant/picture_size (" + std::to_string(picture_size) + ")",
                tile_width);
  plant.require(tile_softness >= 1.0 && isPositive(tile_softness), "tile_softness",
                "be >= 1 and finite", tile_softness);
  plant.add(PlantOptions::problems());
  return plant.problems();
}

MovingTile::MovingTile(const MovingTileOptions& options)
    : Plant(infoOf(checked(options))),
      lowest_(options.tile_width / 2),
      highest_(options.picture_size - options.tile_width / 2),
      renderer_(options.picture_size, options.tile_width, options.tile_softness) {}

Eigen::VectorXd MovingTile::advance(const Eigen::VectorXd& state,
                                    const Eigen::VectorXd& torque) const {
  return (state + torque).unaryExpr([this](double position) {
    return reflected(position, lowest_, highest_);
  });
}

double MovingTile::distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const {
  return (state - goal).stableNorm();
}

Picture MovingTile::draw(const Eigen::VectorXd& state) const { return renderer_.render(state); }

}  // namespace ddm
