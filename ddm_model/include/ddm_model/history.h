// Controller state x: the last n features and the last n-1 torques; and states of a data set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <vector>

#include "ddm_model/data_set.h"

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
    push(z, &features_);
  }

  /// Takes in the torque [N m] that answers the image just seen.
  void apply(const Eigen::VectorXd& u) {
    if (torques_.cols() > 0) push(u, &torques_);
  }

  bool empty() const { return empty_; }
  /// z_t, z_{t-1}, ...: the newest first  [feature_dim x (n + d)]
  const Eigen::MatrixXd& features() const { return features_; }
  /// u_{t-1}, u_{t-2}, ...: the newest first [N m]  [torque_dim x (n + d - 1)]
  const Eigen::MatrixXd& torques() const { return torques_; }

 private:
  /// Puts the newest column first and drops the oldest.
  static void push(const Eigen::VectorXd& newest, Eigen::MatrixXd* columns) {
    for (Eigen::Index lag = columns->cols() - 1; lag > 0; --lag) {
      columns->col(lag) = columns->col(lag - 1);
    }
    columns->col(0) = newest;
  }

  Eigen::MatrixXd features_;
  Eigen::MatrixXd torques_;
  bool empty_ = true;
};

/// Farthest-point sampling (Gonzalez, Theoretical Computer Science 1985): each point after the first is
/// the one that is farthest from all that are chosen before it.
/// @param points     one per column, at least one  [dim x N]
/// @param max_count  of points; there are fewer where fewer are different
/// @return           numbers of the columns, 0 first
std::vector<Eigen::Index> farthestPoints(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                         Eigen::Index max_count);

/// States x_t (eq. 8, see History) of frames, chosen by farthest points (z_t, z_t - z_{t-1}), both in units
/// of their spread.
/// @param Z          features of all frames, others may follow           [feature_dim x >= N]
/// @param data       torques and segments of the frames
/// @param memory     n + d, the frames of a state
/// @param max_count  of support states
/// @return           z_t ... z_{t-n-d+1}, then u_{t-1} ... u_{t-n-d+1} [N m], in each column
Eigen::MatrixXf supportStates(const Eigen::Ref<const Eigen::MatrixXf>& Z, const DataSet& data,
                              int memory, Eigen::Index max_count);

}  // namespace ddm
