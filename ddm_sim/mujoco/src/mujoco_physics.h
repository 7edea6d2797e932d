// Moves a model: states in, states out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "load_model.h"
#include "motors.h"

namespace ddm {

/// @throws std::invalid_argument naming a joint that is neither hinge nor slide, or if there is no
///         joint
void requirePositionsAndRates(const MujocoModel& model);

/// Time of a physics frame: that of the options, else of the file [s].
double timestepOf(const MujocoModel& model, const MujocoOptions& options);

/// A model with a workspace of its own; for one thread at a time. What it returns depends on its
/// arguments alone.
///
/// If the options name motors, all actuators of the file are switched off, and only the torques of
/// these motors act.
class MujocoPhysics {
 public:
  /// @throws std::invalid_argument as motorsOf()
  MujocoPhysics(std::shared_ptr<const MujocoModel> model, const MujocoOptions& options);

  int numJoints() const { return physics_.njnt; }

  /// The states after each of `num_frames` frames under a constant torque.
  /// @param torque  of each motor                                                      [m x 1]
  /// @return        one state per column                                     [2 nq x num_frames]
  /// @throws std::range_error with MuJoCo's reason if the simulation is unstable
  Eigen::MatrixXd frames(const Eigen::VectorXd& state, const Eigen::VectorXd& torque,
                         int num_frames) const;

  /// The model in this state, as far as positions go: bodies, sites, cameras and lights.
  /// @param target  (optional) where to put the mocap body `target`, if the model has one [m].
  ///                Without it, this body is where the file puts it.
  const mjData& placed(const Eigen::VectorXd& state,
                       const std::optional<Eigen::Vector2d>& target = std::nullopt) const;

  /// Where these are in the world [m].                                              [3 n x 1]
  Eigen::VectorXd places(const std::vector<Place>& places, const Eigen::VectorXd& state) const;

  /// Centres of mass of all bodies that a joint can move [m].                       [3 n x 1]
  Eigen::VectorXd bodies(const Eigen::VectorXd& state) const;

  /// A state at rest that brings a place to this point of the x-y plane; near `guess` if it can be.
  /// @throws std::invalid_argument if there is none within the ranges of the joints
  Eigen::VectorXd reach(const Place& place, const Eigen::Vector2d& point,
                        const Eigen::VectorXd& guess) const;

 private:
  const mjtNum* at(const Place& place) const;
  void set(const Eigen::VectorXd& state) const;
  void requireStable(int frame, const Eigen::VectorXd& state) const;
  bool approach(const Place& place, const Eigen::Vector2d& point, Eigen::VectorXd* state) const;
  bool withinRanges(const Eigen::VectorXd& state) const;

  std::shared_ptr<const MujocoModel> model_;
  mjModel physics_;  // shares all arrays with model_
  std::vector<Motor> motors_;
  DataPointer data_;
};

}  // namespace ddm
