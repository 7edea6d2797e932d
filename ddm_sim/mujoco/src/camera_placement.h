// Finds a camera position from which all poses of a model are visible.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/renderer.h"
#include "mechanism.h"

namespace ddm {

/// Corners of the boxes around all drawn shapes that a joint can move, in the world [m]  [3 x 8 n].
Eigen::Matrix3Xd movingCorners(const mjModel& m, const mjData& placed);

/// Returns a camera that sees all poses, from the direction that shows the motion of each joint
/// best. For a mechanism that moves in one plane this direction is perpendicular to the plane.
/// @param poses  positions of all joints, at least eight poses
/// @param look   how images are drawn; the function fills in `position` and `look_at`
RenderOptions placedCamera(const MujocoModel& model, const Mechanism& mechanism,
                           const std::vector<Eigen::VectorXd>& poses, const RenderOptions& look);

}  // namespace ddm
