// Multi-step prediction: the regressor h_n, and predictions of f put one after the other.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/networks.h"

namespace ddm {

/// Predictions of one or more steps, for training, planning and reports alike: features up to some
/// frame are given, those of the frame after it, the target, and of the frames that follow are
/// predicted,
///
///   z_{t+1} = f(h_n) + offset,   h_n = [z_t, u_{t-d}, ..., z_{t-n+1}, u_{t-n+1-d}]        eq. (2)
///
/// where a feature in h_n is the predicted one from the target on. Any number of targets is
/// predicted at once; each has its own column. Holds the record of the forward pass that the
/// backward pass needs. Memory is taken when more targets or steps are first asked for.
template <class Scalar>
class RollOut {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  /// Frames that are predicted first, n + d or larger; refers to the caller's.
  using Targets = Eigen::Map<const Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1>>;

  /// @param f  outlives the roll-out
  explicit RollOut(const PredictionModel<Scalar>& f);

  /// Takes the memory for so many targets and steps at once.
  void reserve(Eigen::Index num_targets, int num_steps);

  /// backward() adds the Kronecker factors of f to these, one for each layer, from now on; null: no more.
  void collect(KroneckerFactors<Scalar>* factors) {
    for (typename Mlp<Scalar>::Tape& tape : tapes_) tape.factors = factors;
  }

  /// Predicts. predicted() holds the result.
  /// @param theta_p  parameters of f                                                     [P_f]
  /// @param Z        features of all frames before the last target   [feature_dim x >= target]
  /// @param U        torques of all frames [N m]; roll-outs that last longer repeat the last one
  ///                                                                            [torque_dim x N]
  /// @param offset   added to each prediction; null: none                          [feature_dim]
  void forward(const Scalar* theta_p, const Eigen::Ref<const Matrix>& Z,
               const Eigen::Ref<const Eigen::MatrixXd>& U, const Targets& targets, int num_steps,
               const Vector* offset = nullptr);

  /// Features predicted for the frame `step` steps after each target  [feature_dim x targets]
  typename Matrix::ColsBlockXpr predicted(int step) { return predicted_[step].leftCols(count_); }
  typename Matrix::ConstColsBlockXpr predicted(int step) const {
    return predicted_[step].leftCols(count_);
  }

  /// dV/d predicted(step), to be set by the caller before backward()  [feature_dim x targets]
  typename Matrix::ColsBlockXpr dPredicted(int step) { return d_predicted_[step].leftCols(count_); }

  /// Vector-Jacobian product of one step of forward(), to be called for all steps, the last one
  /// first: it ADDS to dPredicted() of earlier steps, and to what is not null.
  /// @param theta_p, targets  of the forward pass
  /// @param d_theta_p  dV/d theta_P; null: not wanted                                    [P_f]
  /// @param d_Z        dV/dZ; null: not wanted                       [feature_dim x >= target]
  /// @param d_U        dV/dU [1/(N m)]; null: not wanted                        [torque_dim x N]
  /// @pre no roll-out is longer than U where d_U is wanted
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
