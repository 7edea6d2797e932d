// A plant for a model file that has none yet: what the file says, and a proposal for the rest.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_sim/plant.h"

namespace ddm {

/// A joint as a proposal sees it.
struct ModelJoint {
  std::string name;
  JointKind kind = JointKind::kAngle;
  bool limited = false;
  double lower =
      0.0;  ///< limits of the file; of a joint without limits those of the poses [rad, m]
  double upper = 0.0;
  double shown_lower = 0.0;  ///< what the camera shows of them [rad, m]
  double shown_upper = 0.0;
  double effort = 0.0;  ///< limit of a motor here by the file [N m, N]; 0: the file does not say

  bool shownInPart() const { return limited && (shown_lower > lower || shown_upper < upper); }
  bool turnsFar() const { return kind == JointKind::kAngle && upper - lower > 3.2; }
};

/// All joints of a model, in its order.
/// @throws std::invalid_argument if one is neither a hinge nor a slide
std::vector<ModelJoint> jointsOf(const std::shared_ptr<const MujocoModel>& model);

/// Which joints have a motor, as far as the file says.
struct MotorChoice {
  std::vector<std::string> joints;      ///< one or two; none: somebody has to choose
  bool by_actuators = false;            ///< the file's own motors: `plant/motors` stays empty
  std::vector<std::string> candidates;  ///< joints that could have one
  std::string why;                      ///< a sentence
};

/// The joints that the <transmission> elements of a URDF give a motor; none in other files.
/// @param text  of the model file
std::vector<std::string> transmissionJoints(const std::string& text);

/// The actuators of the file; without any the joints of its transmissions, those with an effort limit, or
/// the only joint.
MotorChoice chooseMotors(const MujocoModel& model, const std::vector<ModelJoint>& joints,
                         const std::vector<std::string>& transmissions);

struct PlantProposal {
  MujocoOptions options;
  int feature_dim = 2;  ///< proposed model/feature_dim
  std::vector<ModelJoint> joints;
  std::map<std::string, std::string> reasons;  ///< by key of the block: how its value came about
  std::vector<std::string> to_set;             ///< keys that a person has to decide
  std::vector<Eigen::VectorXd> poses;          ///< random states at rest
};

/// Proposes every key that a plant of this model needs. The camera sees all poses that the joints'
/// limits allow, and looks along the axes of parallel hinges.
/// @param choice      which joints have a motor; `joints` is not empty
/// @param max_torque  limits of the motors; empty: the file's, or estimated from gravity and inertia
/// @throws std::invalid_argument naming what does not fit the model
/// @throws std::range_error with MuJoCo's reason if the simulation is unstable
PlantProposal proposePlant(const std::shared_ptr<const MujocoModel>& model,
                           const MotorChoice& choice, const std::vector<double>& max_torque);

/// How a plant behaves and what its image shows.
struct PlantCheck {
  double still_speed = 0.0;         ///< fastest joint in 2 s without torque [rad/s, m/s]
  double random_speed = 0.0;        ///< and under random torques
  int changed_pixels = 0;           ///< that differ between two poses, median
  int contrast = 0;                 ///< largest change of a pixel [grey 0 ... 255]
  std::vector<std::string> unseen;  ///< joints that can move without a change of the image
  double share_outside = 0.0;  ///< of the images of random trials: a joint beyond what is shown
};

/// @param plant  of the proposal; its state is changed
/// @throws std::range_error with MuJoCo's reason if the simulation is unstable
PlantCheck checkPlant(const PlantProposal& proposal, Plant* plant);

}  // namespace ddm
