// Proposes plant options for a model file that has no plant file yet.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// A joint with the properties that a proposal needs. Positions are in rad or m.
struct ModelJoint {
  std::string name;
  JointKind kind = JointKind::kAngle;
  bool limited = false;
  /// Limits of the file. A joint without limits has the range of the proposed poses.
  double lower = 0.0;
  double upper = 0.0;
  /// Limit of a motor at this joint in the file [N m or N]; 0: the file has no limit.
  double effort = 0.0;

  bool isHinge() const { return kind == JointKind::kAngle; }
  bool turnsFreely() const { return isHinge() && !limited; }
};

struct PlantProposal {
  MujocoOptions options;
  std::vector<ModelJoint> joints;
  std::vector<std::string> motors;  ///< joints that have a motor, also through the file's actuators
  /// For each key of the block `plant`: why the key has this value.
  std::map<std::string, std::string> reasons;
  std::set<std::string> to_set;        ///< keys that a person has to decide
  std::vector<Eigen::VectorXd> poses;  ///< random states at rest
};

/// Proposes a value for every key that a plant of this model needs. The proposed camera sees all
/// poses within the joints' limits and looks along the axes of parallel hinges.
/// @param motors      joints that have a motor. Empty: the joints of the file's actuators. If the
///         file has no actuators, the joints of its transmissions, else the joints with an effort
///         limit, else the only joint
/// @param max_torque  limits of the motors. Empty: the limits of the file, or estimates from
///         gravity and inertia
/// @throws std::invalid_argument naming an argument that does not fit the model, or the joints that
///         could have a motor if the file does not say which one or two joints have a motor
/// @throws std::range_error with MuJoCo's reason if the simulation is unstable
PlantProposal proposePlant(const std::shared_ptr<const MujocoModel>& model,
                           const std::vector<std::string>& motors,
                           const std::vector<double>& max_torque);

/// How much the images of a plant change.
struct PlantCheck {
  int changed_pixels = 0;           ///< pixels that differ between two poses (median) [-]
  std::vector<std::string> unseen;  ///< joints whose motion does not change the image
};

/// @param plant  plant with the proposed options
PlantCheck checkPlant(const PlantProposal& proposal, const Plant& plant);

}  // namespace ddm
