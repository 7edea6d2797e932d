// Equations of motion and renderer of the moving tile.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/moving_tile.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ddm {
namespace {

PlantInfo infoOf(const MovingTileOptions& options) {
  const double size = options.image_size;
  const double margin = kTileWidth / 2;
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

/// Coverage of each pixel of a line: the fraction of its window [j + 1/2 - s / 2, j + 1/2 + s / 2]
/// that [middle - w / 2, middle + w / 2] covers.
std::vector<double> coverage(int size, double middle) {
  const double first = middle - kTileWidth / 2;
  const double last = middle + kTileWidth / 2;
  // The window exceeds the pixel by this margin on each side.
  const double margin = (kTileSoftness - 1.0) / 2;
  std::vector<double> out(size);
  for (int j = 0; j < size; ++j) {
    const double overlap = std::min(last, j + 1.0 + margin) - std::max(first, j - margin);
    out[j] = std::max(0.0, overlap) / kTileSoftness;
  }
  return out;
}

/// Reflects `position` at both ends of [lowest, highest], as often as necessary (a triangle wave).
double reflected(double position, double lowest, double highest) {
  return lowest + std::abs(std::remainder(position - lowest, 2 * (highest - lowest)));
}

}  // namespace

RenderedImage drawTile(int size, const Eigen::Vector2d& centre) {
  const std::vector<double> columns = coverage(size, centre.x());
  const std::vector<double> rows = coverage(size, centre.y());
  std::vector<std::uint8_t> bytes;
  bytes.reserve(static_cast<std::size_t>(size) * size);
  for (const double row : rows) {
    for (const double column : columns) {
      bytes.push_back(static_cast<std::uint8_t>(255.0 * row * column + 0.5));
    }
  }
  return brightOnBlack(size, std::move(bytes));
}

std::vector<std::string> MovingTileOptions::problems() const {
  OptionChecks plant("plant");
  plant.require(image_size > kTileWidth, "image_size", "be more than the tile's 9 pixels",
                image_size);
  plant.add(PlantOptions::problems());
  return plant.problems();
}

MovingTile::MovingTile(const MovingTileOptions& options)
    : Plant(infoOf(checked(options))),
      size_(options.image_size),
      highest_(options.image_size - kTileWidth / 2) {}

Eigen::VectorXd MovingTile::advance(const Eigen::VectorXd& state,
                                    const Eigen::VectorXd& torque) const {
  return (state + torque).unaryExpr([this](double position) {
    return reflected(position, kTileWidth / 2, highest_);
  });
}

double MovingTile::distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const {
  return (state - goal).stableNorm();
}

RenderedImage MovingTile::draw(const Eigen::VectorXd& state) const {
  return drawTile(size_, state);
}

}  // namespace ddm
