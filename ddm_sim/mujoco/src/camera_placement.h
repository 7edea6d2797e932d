// Where a camera has to stand to see all poses of a model.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"

namespace ddm {

struct CameraPlace {
  Eigen::Vector3d position;  ///< [m]
  Eigen::Vector3d look_at;   ///< [m]
};

/// The model in this pose, as far as positions go.
using PlaceModel = std::function<const mjData&(const Eigen::VectorXd& positions)>;

/// Corners of the boxes around all drawn shapes that a joint can move, in the world [m]  [3 x n]
Eigen::Matrix3Xd movingCorners(const MujocoModel& model, const mjData& placed);

/// Places that see all of these poses, in the directions that show the motion of each joint best. Of
/// a mechanism whose joints move it in one plane, this is the perpendicular of that plane.
/// @param poses          positions of all joints                                      [not empty]
/// @param field_of_view  vertical and horizontal [deg]
/// @return               not empty, the most usual direction first
std::vector<CameraPlace> cameraPlaces(const MujocoModel& model, const PlaceModel& place,
                                      const std::vector<Eigen::VectorXd>& poses,
                                      double field_of_view);

}  // namespace ddm
