// A model at rest: where its joints may be, and the loads on them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <random>
#include <vector>

#include "ddm_mujoco/mujoco_model.h"
#include "ddm_mujoco/plant_proposal.h"
#include "load_model.h"

namespace ddm {

/// For one thread at a time. Positions are those of all joints                              [n x 1]
class Mechanism {
 public:
  /// @throws std::invalid_argument as requirePositionsAndRates()
  explicit Mechanism(const std::shared_ptr<const MujocoModel>& model);

  const std::vector<ModelJoint>& joints() const { return joints_; }

  /// The length that motions of a joint compare with: 1 rad, or half the size of the robot.
  double unit(int joint) const { return joints_[joint].isHinge() ? 1.0 : 0.5 * size_; }

  /// Pose 0 of the file, within the limits.
  Eigen::VectorXd zero() const;

  /// A random pose that the camera should show.
  Eigen::VectorXd draw(std::mt19937_64* engine) const;

  /// Within the limits, and with the positions of joints that follow others.
  Eigen::VectorXd coupled(Eigen::VectorXd position) const;

  /// The model at rest in this pose.
  const mjData& place(const Eigen::VectorXd& position) const;

  /// Torque that weight and springs ask for at rest: the gradient of energy().
  Eigen::VectorXd load(const Eigen::VectorXd& position, bool springs = true) const;

  /// Of weight and springs [J].
  double energy(const Eigen::VectorXd& position, bool springs = true) const;

  /// Inertia that a motor of this joint feels [kg m^2, kg].
  double inertia(int joint, const Eigen::VectorXd& position) const;

  /// Where the mechanism goes by its weight and springs if it is slow.
  Eigen::VectorXd settled(const Eigen::VectorXd& position) const {
    return followed(position, -1.0);
  }

  /// The pose of the most energy that weight gives.
  Eigen::VectorXd highest(const std::vector<Eigen::VectorXd>& poses) const;

 private:
  Eigen::VectorXd followed(Eigen::VectorXd position, double sign) const;
  void showSlidesInPart();

  std::shared_ptr<const MujocoModel> model_;
  DataPointer data_;
  std::vector<ModelJoint> joints_;
  double size_ = 1.0;  // [m]
};

}  // namespace ddm
