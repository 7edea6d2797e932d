// A plant for a model file that has none yet: what the file says, and a proposal for the rest.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// A joint as a proposal sees it. Positions are in rad or m.
struct ModelJoint {
  std::string name;
  JointKind kind = JointKind::kAngle;
  bool limited = false;
  double lower = 0.0;  ///< limits of the file; of a joint without limits those of the poses
  double upper = 0.0;
  double shown_lower = 0.0;  ///< the part of them that the camera shows
  double shown_upper = 0.0;
  double effort = 0.0;  ///< limit of a motor here by the file [N m, N]; 0: the file does not say

  bool isHinge() const { return kind == JointKind::kAngle; }
  bool shownInPart() const { return limited && (shown_lower > lower || shown_upper < upper); }
  bool turnsFar() const { return isHinge() && upper - lower > 3.2; }
};

struct PlantProposal {
  MujocoOptions options;
  int feature_dim = 2;  ///< proposed model/feature_dim
  std::vector<ModelJoint> joints;
  std::vector<std::string> motors;  ///< joints that have a motor, also by actuators of the file
  std::map<std::string, std::string> reasons;  ///< by key of the block: how its value came about
  std::vector<std::string> to_set;             ///< keys that a person has to decide
  std::vector<Eigen::VectorXd> poses;          ///< random states at rest
};

/// Proposes every key that a plant of this model needs. The camera sees all poses that the joints'
/// limits allow, and looks along the axes of parallel hinges.
/// @param motors      joints that have a motor; empty: the joints of the file's actuators, without
///                    any those of its transmissions, those with an effort limit, or the only joint
/// @param max_torque  limits of the motors; empty: the file's, or estimated from gravity and inertia
/// @throws std::invalid_argument naming what does not fit the model, or the joints that could have a
///         motor if the file does not say which one or two have one
/// @throws std::range_error with MuJoCo's reason if the simulation is unstable
PlantProposal proposePlant(const std::shared_ptr<const MujocoModel>& model,
                           const std::vector<std::string>& motors,
                           const std::vector<double>& max_torque);

/// How a plant behaves and what its image shows.
struct PlantCheck {
  double still_speed = 0.0;         ///< fastest joint in 2 s without torque [rad/s, m/s]
  double random_speed = 0.0;        ///< and under random torques
  int changed_pixels = 0;           ///< that differ between two poses, median
  std::vector<std::string> unseen;  ///< joints that can move without a change of the image
};

/// @param plant  of the proposal; its state is changed
/// @throws std::range_error with MuJoCo's reason if the simulation is unstable
PlantCheck checkPlant(const PlantProposal& proposal, Plant* plant);

}  // namespace ddm
