// A plant that a model file describes, moved by MuJoCo.
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

/// The state is all positions, then all rates, in the order of the joints in the file; hinges [rad]
/// and slides [m] alone, an angle is never wrapped. A step is dt / h physics frames, h the time
/// step of the file, under the torques u at the joints of the motors, and depends on state and torque
/// alone: nothing is carried over from the frames before.
///
/// Goal: `goal`, or with `goal_site` for each run a pose that brings this site to a point of its
/// x-y plane. Error: the largest distance of a joint (angles the short way round [deg], slides [m])
/// or of a site [m] to where it is at the goal.
class MujocoPlant : public Plant {
 public:
  /// @throws std::invalid_argument with the value, the rule and what helps, if options and model do
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
  Picture view(const Eigen::VectorXd& state) const override;

 private:
  Eigen::VectorXd advance(const Eigen::VectorXd& state,
                          const Eigen::VectorXd& torque) const override;
  double rewardOfStep(const Eigen::VectorXd& state, const Eigen::VectorXd& torque) const override;
  double distance(const Eigen::VectorXd& state, const Eigen::VectorXd& goal) const override;
  Picture draw(const Eigen::VectorXd& state) const override;
  Eigen::VectorXd locate(const Eigen::VectorXd& state) const override;

  std::shared_ptr<const MujocoModel> model_;
  std::unique_ptr<const MujocoPhysics> physics_;
  int num_frames_;                 // of a time step
  Eigen::VectorXd start_normal_;   // standard deviation of this part of the start
  Eigen::VectorXd start_uniform_;  // half-width of that one
  std::vector<int> error_joints_;  // empty: error_sites_ count
  std::vector<Place> error_sites_;
  std::vector<Place> visible_sites_;  // empty: all bodies
  std::vector<Place> goal_site_;      // none: the goal is always the same
  std::vector<double> goal_distance_;
  std::unique_ptr<Renderer> image_;  // what the learner sees
  std::unique_ptr<Renderer> view_;   // what people see
  const Reward* reward_;             // null: none
  Eigen::VectorXd reward_scale_;     // torque of each motor that is a control of 1
};

/// Draws a few poses of a plant, which takes as long as opening the renderer.
/// @throws std::invalid_argument with the likely cause if the images of all poses are equal.
///         Nothing is checked, and nothing thrown, where OpenGL cannot draw.
void requireVisible(const std::shared_ptr<const MujocoModel>& model, const MujocoOptions& options);

/// The options with what the files say where they are silent: limits of motors, and the digest.
/// @throws std::invalid_argument if the digest is that of other files, or as MujocoPlant
MujocoOptions completed(MujocoOptions options, const MujocoModel& model);

}  // namespace ddm
