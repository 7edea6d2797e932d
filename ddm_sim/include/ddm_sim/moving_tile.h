// The paper's moving tile: a square that is pushed about in the picture.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/plant.h"
#include "ddm_sim/plant_options.h"
#include "ddm_sim/tile_renderer.h"

namespace ddm {

/// Tile with the state (x, y), its centre in the picture [pixels], and two inputs.
///
///   (x, y)+ = reflect((x, y) + u),   reflect into [w/2, size - w/2] in each direction
///
/// x runs to the right and y downwards from the upper left corner of the picture, which spans
/// [0, size]; w is the width of the tile. The "torques" u are increments of position [pixels], one
/// to the right and one downwards; there are no rates. A tile that would leave the picture bounces
/// off the border with all of its way, as often as it takes, and so stays wholly inside. step()
/// reports the increment before the reflection.
///
/// It starts around the middle of the picture. Its goal is (3/4 size, 1/4 size), or the nearest
/// place that it can reach. A start state may lie outside, where the picture shows a part of the
/// tile or none; the next step brings it back.
/// Deviation: the paper gives neither the size of the tile nor the range of the increments, nor
/// what happens at the border; these are ours.
class MovingTile : public Plant {
 public:
  /// Of the keys of the camera that draw a plant, `size` alone matters.
  /// @throws std::invalid_argument with all problems of both blocks, a tile too large for the
  ///         picture among them
  MovingTile(const PlantOptions& plant, const CameraOptions& camera);

  Eigen::VectorXd goalState() const override;
  bool turns() const override { return false; }
  int imageSize() const override { return renderer_.size(); }
  std::vector<std::string> jointNames() const override { return {"x", "y"}; }
  std::vector<std::string> stateNames() const override { return {"x_px", "y_px"}; }
  std::vector<std::string> torqueNames() const override { return {"dx_px", "dy_px"}; }

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double distanceToGoal(const Eigen::VectorXd& state) const override;
  std::vector<std::uint8_t> draw(const Eigen::VectorXd& state) const override;
  std::vector<std::uint8_t> cover(const Eigen::VectorXd& state) const override {
    return draw(state);  // white on black
  }
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override { return state; }

  double lowest_;   ///< w / 2, least coordinate of the centre [pixels]
  double highest_;  ///< size - w / 2, its greatest [pixels]
  TileRenderer renderer_;
};

}  // namespace ddm
