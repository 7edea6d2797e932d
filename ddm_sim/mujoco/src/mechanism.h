// Class Mechanism: a model with the ranges of its joints, the loads on them, and random motions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <random>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/mujoco_options.h"
#include "ddm_mujoco/plant_proposal.h"
#include "model_files.h"

namespace ddm {

/// State of a mechanism at rest: positions and zero rates.
/// @param position  of all joints  [n x 1]
/// @return [2 n x 1]
Eigen::VectorXd atRest(const Eigen::VectorXd& position);

/// A model at rest. Use an object in one thread at a time. A position has one number for each joint
/// [n x 1].
class Mechanism {
 public:
  /// @throws std::invalid_argument as requirePositionsAndRates()
  explicit Mechanism(const std::shared_ptr<const MujocoModel>& model);

  const std::vector<ModelJoint>& joints() const { return joints_; }

  /// Scale for motions of a joint: 1 rad for a hinge, the size of the robot [m] for a slide.
  double unit(int joint) const { return joints_[joint].isHinge() ? 1.0 : size_; }

  /// Pose qpos0 of the file, as coupled().
  Eigen::VectorXd zero() const { return coupled(qpos0()); }

  /// Draws a random pose within the ranges of the joints.
  Eigen::VectorXd draw(std::mt19937_64* engine) const;

  /// Whether the position of a joint is a function of another joint, as with <mimic>.
  bool follows(int joint) const;

  /// Sets the joints that follow other joints, and moves a position into the ranges.
  Eigen::VectorXd coupled(Eigen::VectorXd position) const;

  /// The position with each limited joint at the nearer limit, as coupled().
  Eigen::VectorXd atLimits(Eigen::VectorXd position) const;

  /// Whether shapes of the robot and its surroundings overlap, if the model has contacts.
  bool overlaps(const Eigen::VectorXd& position) const;

  /// The model at rest in this pose.
  const mjData& place(const Eigen::VectorXd& position) const;

  /// Torque that balances weight and springs at rest: the gradient of energy()  [n x 1].
  Eigen::VectorXd load(const Eigen::VectorXd& position, bool springs = true) const;

  /// Potential energy of weight and springs [J].
  double energy(const Eigen::VectorXd& position, bool springs = true) const;

  /// Rates of all joints for a rate of 1 of this joint, which other joints may follow  [n x 1].
  Eigen::VectorXd motion(int joint, const Eigen::VectorXd& position) const;

  /// Inertia against these rates of all joints, such as motion() [kg m^2 or kg].
  double inertia(const Eigen::VectorXd& rates, const Eigen::VectorXd& position) const;

  /// Position to which weight and springs move the mechanism slowly.
  Eigen::VectorXd settled(const Eigen::VectorXd& position) const {
    return followed(position, -1.0);
  }

  /// Position with the largest potential energy of weight.
  Eigen::VectorXd highest(const std::vector<Eigen::VectorXd>& poses) const;

  /// Simulates several runs under random torques from the start and from the goal of the options.
  /// @param share  share of options.max_torque that the random torques reach
  /// @return speed that the fastest joint exceeds in 5 % of the physics steps, in units of the
  ///         joints per second, see unit()
  /// @throws std::range_error if the simulation is unstable
  double speedUnderRandomTorques(const MujocoOptions& options, std::size_t num_motors,
                                 double share) const;

 private:
  Eigen::VectorXd withFollowers(Eigen::VectorXd position) const;
  Eigen::VectorXd followed(Eigen::VectorXd position, double sign) const;
  Eigen::VectorXd qpos0() const;

  std::shared_ptr<const MujocoModel> model_;
  DataPointer data_;
  std::vector<ModelJoint> joints_;
  double size_ = 1.0;  // largest side of the box around the moving shapes at qpos0 [m]
};

/// Corners of the boxes around all drawn shapes that a joint can move, in the world [m]  [3 x 8 n].
Eigen::Matrix3Xd movingCorners(const mjModel& m, const mjData& placed);

/// Returns a camera that sees all poses, from the direction that shows the motion of each joint
/// best. For a mechanism that moves in one plane this direction is perpendicular to the plane.
/// @param poses  positions of all joints, at least eight poses
/// @param look   how images are drawn; the function fills in `position` and `look_at`
RenderOptions placedCamera(const std::shared_ptr<const MujocoModel>& model,
                           const Mechanism& mechanism, const std::vector<Eigen::VectorXd>& poses,
                           const RenderOptions& look);

}  // namespace ddm
