// MPC state x: the last n features and the last n-1 torques.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <stdexcept>

namespace ddm {

/// x_t = [z_t, ..., z_{t-n+1}, u_{t-1}, ..., u_{t-n+1}] (paper, eq. 8). At the start of a trial
/// the first feature stands for those before it, with torque 0: the plant is taken to be at rest. Where
/// images are d frames late, both reach back d frames more.
class History {
 public:
  /// @param memory  n + d, see ModelOptions
  /// @throws std::invalid_argument if one is < 1
  History(int memory, int feature_dim, int torque_dim) {
    if (memory < 1 || feature_dim < 1 || torque_dim < 1) {
      throw std::invalid_argument("history: memory and dimensions must be >= 1");
    }
    features_.setZero(feature_dim, memory);
    torques_.setZero(torque_dim, memory - 1);
  }

  /// Forgets everything: the next feature is the first of a trial.
  void clear() {
    empty_ = true;
    torques_.setZero();
  }

  /// Takes in the feature of the image just seen.
  void observe(const Eigen::VectorXd& z) {
    if (empty_) {
      features_.colwise() = z;
      empty_ = false;
      return;
    }
    for (Eigen::Index lag = features_.cols() - 1; lag > 0; --lag) {
      features_.col(lag) = features_.col(lag - 1);
    }
    features_.col(0) = z;
  }

  /// Takes in the torque [N m] that answers the image just seen.
  void apply(const Eigen::VectorXd& u) {
    if (torques_.cols() == 0) return;
    for (Eigen::Index lag = torques_.cols() - 1; lag > 0; --lag) {
      torques_.col(lag) = torques_.col(lag - 1);
    }
    torques_.col(0) = u;
  }

  bool empty() const { return empty_; }
  /// z_t, z_{t-1}, ...: the newest first  [feature_dim x (n + d)]
  const Eigen::MatrixXd& features() const { return features_; }
  /// u_{t-1}, u_{t-2}, ...: the newest first [N m]  [torque_dim x (n + d - 1)]
  const Eigen::MatrixXd& torques() const { return torques_; }

 private:
  Eigen::MatrixXd features_;
  Eigen::MatrixXd torques_;
  bool empty_ = true;
};

}  // namespace ddm
