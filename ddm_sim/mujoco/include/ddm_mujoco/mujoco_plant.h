// Class MujocoPlant: a plant that a model file describes and that MuJoCo simulates.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_mujoco/renderer.h"
#include "ddm_mujoco/rewards.h"
#include "ddm_sim/plant.h"

namespace ddm {

class MujocoPhysics;

/// Plant with the physics of a MuJoCo model.
///
///   state = (q_1 ... q_n, dq_1/dt ... dq_n/dt),   joints in the order of the file
///
/// Joints are hinges [rad] or slides [m]. Angles are never wrapped. One time step dt consists of dt
/// / h physics steps, where h is the time step of the model, under constant torques u at the
/// motors' joints. The next state depends only on the state and the torque, because MuJoCo's solver
/// starts each time step without a memory of earlier steps.
///
/// The goal is the option `goal`. With the option `goal_site` the goal is instead drawn for each
/// episode: a pose that brings this site to a point of the x-y plane. The error is the largest
/// distance of a site in `error_sites` from its position in the goal state [m]. Without such sites
/// it is that of a hinge from its goal angle, the short way round [deg], or, in a model without
/// hinges, of a slide from its goal position [m].
class MujocoPlant : public Plant {
 public:
  /// @throws std::invalid_argument with the value, the rule and the remedy if options and model do
  ///         not fit together
  MujocoPlant(std::shared_ptr<const MujocoModel> model, const MujocoOptions& options);
  ~MujocoPlant() override;

  Eigen::VectorXd drawStart(std::mt19937_64& engine) const override;
  Eigen::VectorXd drawGoal(std::mt19937_64& engine) const override;
  Eigen::VectorXd goalAt(const Eigen::VectorXd& target) const override;
  std::optional<double> reward(const Eigen::VectorXd& state,
                               const Eigen::VectorXd& torque) const override;
  std::optional<CameraModel> cameraModel() const override;
  std::optional<CameraModel> viewModel() const override;
  RenderedImage view(const Eigen::VectorXd& state) const override;

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double rewardOfStep(const Eigen::VectorXd& state, const Eigen::VectorXd& torque) const override;
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override;
  RenderedImage draw(const Eigen::VectorXd& state) const override;
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override;

  std::shared_ptr<const MujocoModel> model_;
  std::unique_ptr<const MujocoPhysics> physics_;
  int num_frames_;                 // number of physics steps in one time step
  Eigen::VectorXd start_normal_;   // standard deviation of the normal part of the initial state
  Eigen::VectorXd start_uniform_;  // half-width of the uniform part of the initial state
  std::vector<int> error_joints_;  // empty: the error is that of error_sites_
  std::vector<Place> error_sites_;
  std::vector<Place> visible_sites_;  // empty: all bodies
  std::vector<Place> goal_site_;      // empty: all episodes have the same goal
  std::vector<double> goal_distance_;
  std::unique_ptr<Renderer> image_;  // draws the learner's images
  std::unique_ptr<Renderer> view_;   // draws the large images for people
  const Reward* reward_;             // null: the plant has no reward
  Eigen::VectorXd reward_scale_;     // torque of each motor at a control of 1 [N m or N]
};

/// Draws a few poses of a plant and requires that their images differ. Takes about as long as
/// opening the renderer.
/// @throws std::invalid_argument with the likely cause if the images of all poses are equal. Checks
///         nothing and throws nothing if OpenGL cannot draw on this machine.
void requireVisible(const std::shared_ptr<const MujocoModel>& model, const MujocoOptions& options);

/// Fills in the options that the user left empty from the model: limits of motors, and the digest.
/// @throws std::invalid_argument if the option `model_digest` differs from the digest of the files,
///         or as the constructor of MujocoPlant
MujocoOptions completed(MujocoOptions options, const MujocoModel& model);

}  // namespace ddm
