// Where a camera has to stand to see all poses of a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/renderer.h"
#include "mechanism.h"

namespace ddm {

/// Corners of the boxes around all drawn shapes that a joint can move, in the world [m]  [3 x n]
Eigen::Matrix3Xd movingCorners(const mjModel& m, const mjData& placed);

/// The camera that sees all of these poses from the direction that shows the motion of each joint
/// best. Of a mechanism whose joints move it in one plane, this is the perpendicular of that plane.
/// @param poses  positions of all joints, at least eight
/// @param look   how images are drawn; `position` and `look_at` are filled in
RenderOptions placedCamera(const MujocoModel& model, const Mechanism& mechanism,
                           const std::vector<Eigen::VectorXd>& poses, const RenderOptions& look);

}  // namespace ddm
