// Rollouts: the regressor h_n, and multi-step predictions of f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/networks.h"

namespace ddm {

/// Rollouts for training, planning and reports. Given are the features up to the sample before a
/// target. The features of the target and of the samples after it are predicted,
///
///   z_{t+1} = f(h_n) + offset                                                          eq. (2)
///
/// where h_n has predicted features from the target on, and true features before it. Several
/// targets are predicted at once, one per column. The object stores the forward pass for
/// backward(). Memory is allocated when more targets or steps are requested than before.
template <class Scalar>
class RollOut {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  /// Indices of the targets, each >= n. A view: the caller owns the array.
  using Targets = Eigen::Map<const Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1>>;

  /// @param f  must outlive the rollout
  explicit RollOut(const PredictionModel<Scalar>& f);

  /// Allocates the memory for this many targets and steps.
  void reserve(Eigen::Index num_targets, int num_steps);

  /// Sets the Kronecker factors of f, one per layer, to which backward() adds. Null: none. Call it
  /// after reserve(), since steps that are added later have no factors.
  void collect(KroneckerFactors<Scalar>* factors) {
    for (typename Mlp<Scalar>::Tape& tape : tapes_) tape.factors = factors;
  }

  /// Computes the rollouts; read them with predicted().
  /// @param theta_p    parameters of f                                                   [P_f]
  /// @param Z          features of all samples before the last target [feature_dim x >= target]
  /// @param U          torques of all samples [N m]; a rollout that is longer repeats the last
  ///                   torque                                                 [torque_dim x N]
  /// @param targets    first sample to predict, for each rollout
  /// @param num_steps  length of the rollouts
  /// @param offset     added to each prediction; null: none                      [feature_dim]
  void forward(const Scalar* theta_p, const Eigen::Ref<const Matrix>& Z,
               const Eigen::Ref<const Eigen::MatrixXd>& U, const Targets& targets, int num_steps,
               const Vector* offset = nullptr);

  /// @return features predicted for the sample `step` steps after each target
  ///         [feature_dim x targets]
  typename Matrix::ColsBlockXpr predicted(int step) { return predicted_[step].leftCols(count_); }
  typename Matrix::ConstColsBlockXpr predicted(int step) const {
    return predicted_[step].leftCols(count_);
  }

  /// dV/d predicted(step). The caller sets it before backward()  [feature_dim x targets]
  typename Matrix::ColsBlockXpr dPredicted(int step) { return d_predicted_[step].leftCols(count_); }

  /// Vector-Jacobian product of one step of forward(). The caller calls it for all steps, the last
  /// one first. It ADDS to dPredicted() of earlier steps and to each output that is not null.
  /// @param theta_p, targets  as in the forward pass
  /// @param d_theta_p  dV/d theta_P; null: skip                                          [P_f]
  /// @param d_Z        dV/dZ; null: skip                             [feature_dim x >= target]
  /// @param d_U        dV/dU [1/(N m)]; null: skip                              [torque_dim x N]
  /// @pre if d_U is not null, no rollout is longer than U
  void backward(const Scalar* theta_p, const Targets& targets, int step, Scalar* d_theta_p,
                Matrix* d_Z, Eigen::MatrixXd* d_U);

 private:
  void fillRegressors(const Eigen::Ref<const Matrix>& Z, const Eigen::Ref<const Eigen::MatrixXd>& U,
                      const Targets& targets, int step);

  const PredictionModel<Scalar>& f_;
  Eigen::Index count_ = 0;  // targets of the last forward pass
  // One matrix or tape per step, one column per target.
  std::vector<typename Mlp<Scalar>::Tape> tapes_;
  std::vector<Matrix> predicted_;
  std::vector<Matrix> d_predicted_;
  Matrix regressors_;  // h_n of one step
  Matrix d_regressors_;
};

extern template class RollOut<float>;
extern template class RollOut<double>;

}  // namespace ddm
