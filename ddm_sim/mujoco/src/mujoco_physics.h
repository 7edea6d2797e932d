// Class MujocoPhysics: simulates a model from one state to the next.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "model_files.h"
#include "motors.h"

namespace ddm {

/// @throws std::invalid_argument naming a joint that is neither a hinge nor a slide, or if the
///         model has no joint
void requirePositionsAndRates(const MujocoModel& model);

/// Duration of a physics step [s]: the option `timestep`, or the time step of the file.
double timestepOf(const MujocoModel& model, const MujocoOptions& options);

/// A model with its own memory for the simulation. Use an object in one thread at a time. The
/// result of each function depends only on its arguments.
///
/// If the options name motors, MuJoCo disables all actuators of the file, and only the torques of
/// the named motors act.
class MujocoPhysics {
 public:
  /// @throws std::invalid_argument as motorsOf()
  MujocoPhysics(std::shared_ptr<const MujocoModel> model, const MujocoOptions& options);

  int numJoints() const { return physics_.njnt; }

  /// States after each of `num_frames` physics steps under a constant torque.
  /// @param torque  torque of each motor                                                [m x 1]
  /// @return        one state per column                                     [2 nq x num_frames]
  /// @throws std::range_error with MuJoCo's reason if the simulation is unstable
  Eigen::MatrixXd frames(const Eigen::VectorXd& state, const Eigen::VectorXd& torque,
                         int num_frames) const;

  /// Computes positions for this state: bodies, sites, cameras and lights.
  /// @param target  (optional) position of the mocap body `target` [m], used if the model has one.
  ///         Without this argument the body stays where the file puts it.
  const mjData& placed(const Eigen::VectorXd& state,
                       const std::optional<Eigen::Vector2d>& target = std::nullopt) const;

  /// Positions of these places in the world [m].                                          [3 n x 1]
  Eigen::VectorXd places(const std::vector<Place>& places, const Eigen::VectorXd& state) const;

  /// Centres of mass of all bodies that a joint can move [m].                       [3 n x 1]
  Eigen::VectorXd bodies(const Eigen::VectorXd& state) const;

  /// State at rest that brings a place to this point of the x-y plane. The state is near `guess` if
  /// possible.
  /// @throws std::invalid_argument if no state within the ranges of the joints reaches the point
  Eigen::VectorXd reach(const Place& place, const Eigen::Vector2d& point,
                        const Eigen::VectorXd& guess) const;

 private:
  const mjtNum* at(const Place& place) const;
  void set(const Eigen::VectorXd& state) const;
  void requireStable(int frame, const Eigen::VectorXd& state) const;
  bool approach(const Place& place, const Eigen::Vector2d& point, Eigen::VectorXd* state) const;
  bool withinRanges(const Eigen::VectorXd& state) const;

  std::shared_ptr<const MujocoModel> model_;
  mjModel physics_;  // uses the arrays of model_
  std::vector<Motor> motors_;
  DataPointer data_;
};

}  // namespace ddm
