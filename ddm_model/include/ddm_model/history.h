// Controller state x (the last n features and n-1 torques), and support states of a data set.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/data_set.h"

namespace ddm {

/// Controller state x_t = [z_t, ..., z_{t-n+1}, u_{t-1}, ..., u_{t-n+1}] (paper, eq. 8). At the
/// start of a trial the first feature fills all n features and the torques are 0, as if the plant
/// had been at rest.
class History {
 public:
  /// @param order        n
  /// @param feature_dim  dim z
  /// @param torque_dim   number of motors
  History(int order, int feature_dim, int torque_dim)
      : features_(Eigen::MatrixXd::Zero(feature_dim, order)),
        torques_(Eigen::MatrixXd::Zero(torque_dim, order - 1)) {}

  /// Clears the state: the next feature is treated as the first of a trial.
  void clear() {
    empty_ = true;
    torques_.setZero();
  }

  /// Adds z_t, the feature of the newest image  [feature_dim]
  void observe(const Eigen::VectorXd& z) {
    if (empty_) {
      features_.colwise() = z;
      empty_ = false;
      return;
    }
    push(z, &features_);
  }

  /// Adds u_t, the torque that was applied after the newest image [N m]  [torque_dim]
  void apply(const Eigen::VectorXd& u) {
    if (torques_.cols() > 0) push(u, &torques_);
  }

  bool empty() const { return empty_; }
  /// @return z_t, z_{t-1}, ...: newest first  [feature_dim x n]
  const Eigen::MatrixXd& features() const { return features_; }
  /// @return u_{t-1}, u_{t-2}, ...: newest first [N m]  [torque_dim x (n - 1)]
  const Eigen::MatrixXd& torques() const { return torques_; }

 private:
  /// Inserts the newest column at the front and drops the oldest.
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

/// Farthest-point sampling (Gonzalez, Theoretical Computer Science 1985). Starts with column 0 and
/// adds, one at a time, the point whose distance to the chosen points is largest.
/// @param points     one per column, at least one  [dim x N]
/// @param max_count  number of points to choose; fewer are chosen if fewer distinct points exist
/// @return           indices of the chosen columns, 0 first
std::vector<Eigen::Index> farthestPoints(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                         Eigen::Index max_count);

/// Chooses support states: controller states x_t (paper, eq. 8; see History) of samples, selected
/// by farthest-point sampling of (z_t, z_t - z_{t-1}), each part in units of its own spread.
/// @param Z          features of all samples; columns after them are ignored  [feature_dim x >= N]
/// @param data       torques and segments of the samples
/// @param order      n, number of features in a state
/// @param max_count  number of support states at most
/// @return           in each column z_t ... z_{t-n+1}, then u_{t-1} ... u_{t-n+1} [N m]
///                   [n feature_dim + (n - 1) torque_dim x M]
Eigen::MatrixXf supportStates(const Eigen::Ref<const Eigen::MatrixXf>& Z, const DataSet& data,
                              int order, Eigen::Index max_count);

}  // namespace ddm
