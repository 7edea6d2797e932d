// Where a camera has to stand to see all poses of a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/render_options.h"

namespace ddm {

/// The model in this pose, as far as positions go.
using PlaceModel = std::function<const mjData&(const Eigen::VectorXd& positions)>;

/// Corners of the boxes around all drawn shapes that a joint can move, in the world [m]  [3 x n]
Eigen::Matrix3Xd movingCorners(const MujocoModel& model, const mjData& placed);

/// The camera that sees all of these poses from the direction that shows the motion of each joint
/// best. Of a mechanism whose joints move it in one plane, this is the perpendicular of that plane.
/// @param poses  positions of all joints, at least eight
/// @param look   size and field of view, in both directions; `position` and `look_at` are filled in
RenderOptions placedCamera(const MujocoModel& model, const PlaceModel& place,
                           const std::vector<Eigen::VectorXd>& poses, const RenderOptions& look);

}  // namespace ddm
