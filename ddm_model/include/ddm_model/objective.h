// Joint objective V_R + V_P of the deep dynamical model and its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/networks.h"
#include "ddm_model/schedule.h"

namespace ddm {

/// What the objective is computed from: scores and scaled torques of a data set.
template <class Scalar>
struct TrainingData {
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix scores;   ///< PCA scores: all frames, then the goal if there is one  [pca_dim x M]
  Matrix torques;  ///< torques in units of max_torque                  [torque_dim x N]
  std::vector<Piece> pieces;  ///< no prediction straddles two of them
};

/// V = w (V_R + V_P) with (paper, eqs. 1, 4 and 5)
///
///   V_R = sum_t |s_t - g(g^-1(s_t))|^2          over all images, the goal included
///   V_P = sum_t |s_{t+1} - g(f(h_t))|^2         over all frames with n predecessors in their piece
///
/// on PCA scores s: the pixels outside the basis add a constant that no parameter changes. The
/// weight w = 1 / sum_t |s_t|^2 makes V about 1 for a useless model, whatever the data.
/// The encoder runs once for both terms. Samples are walked in blocks that stay in cache; memory is
/// taken once, at construction.
template <class Scalar>
class JointObjective {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  struct Value {
    double v_r = 0.0;  ///< V_R [score^2]
    double v_p = 0.0;  ///< V_P [score^2]
  };

  /// @param networks  shapes; outlives the objective
  /// @throws std::invalid_argument if shapes do not fit, or no piece is longer than n frames
  JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data);

  /// @param theta    parameters                                            [P]
  /// @param d_theta  out: derivative of the sum of `terms`; null: not wanted   [P]
  /// @param terms    which of the two the derivative is of
  /// @return both values, whatever `terms` says
  Value evaluate(const Vector& theta, Vector* d_theta, Terms terms = Terms());

  /// @return w
  double weight() const { return weight_; }
  /// @return number of one-step predictions in V_P
  Eigen::Index numPredictions() const { return static_cast<Eigen::Index>(targets_.size()); }

 private:
  void encode(const Scalar* theta);
  Value decodeBlock(const Scalar* theta, Eigen::Index block, Terms terms, Scalar* d_theta);
  void predict(const Scalar* theta, Eigen::Index first, Eigen::Index count);
  void backwardThroughPrediction(const Scalar* theta, Eigen::Index first, Eigen::Index count,
                                 const Eigen::Ref<const Matrix>& d_predicted, Scalar* d_theta);

  Eigen::Index blockBegin(Eigen::Index block) const;
  Eigen::Index blockSize(Eigen::Index block) const;

  const Networks<Scalar>& networks_;
  TrainingData<Scalar> data_;
  double weight_ = 1.0;
  std::vector<Eigen::Index> targets_;       // frames that are predicted, ascending
  std::vector<Eigen::Index> block_target_;  // first target of each block, and the end
  Matrix features_;                         // z of all images         [feature_dim x M]
  Matrix d_features_;                       // dV/dz                   [feature_dim x M]
  std::vector<typename Mlp<Scalar>::Tape> encoder_tapes_;  // one per block
  typename Mlp<Scalar>::Tape decoder_tape_;
  typename Mlp<Scalar>::Tape predictor_tape_;
  Matrix regressors_;  // h of the block's targets
  Matrix d_regressors_;
  Matrix decoder_input_;  // z of the block, then the predicted z of its targets
  Matrix d_decoder_input_;
  Matrix residual_;
};

extern template class JointObjective<float>;
extern template class JointObjective<double>;

}  // namespace ddm
