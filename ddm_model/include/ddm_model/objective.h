// Joint objective V_R + V_P of the deep dynamical model and its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "ddm_model/networks.h"
#include "ddm_model/roll_out.h"
#include "ddm_model/schedule.h"
#include "ddm_model/training_data.h"

namespace ddm {

/// V = w (V_R + V_P) with (paper, eq. 5a)
///
///   V_R = sum_t |s_t - g(g^-1(s_t))|^2     all images and the goal                 eqs. (1, 5c)
///   V_P = sum_t |s_{t+1} - g(f(h_n))|^2    frames with n predecessors in their     eqs. (4, 5b)
///                                          piece
///
/// With Terms::prediction_steps k > 1, V_P is the mean over predictions 1 ... k steps ahead, each
/// from the one before it:
///
///   V_P = 1/k sum_t sum_{j=1..k} |s_{t+j} - g(z_{t+j|t})|^2
///
/// With Terms::weight_decay w_d > 0, w_d V_W is added, V_W the sum of all squared weights (biases
/// are free): networks that fit few data in many ways are held to the smoothest.
///
/// All on PCA scores s: the pixels outside the basis add a constant that no parameter changes. The
/// weight w = 1 / sum_t |s_t|^2 makes V about 1 for a useless model, whatever the data.
/// Targets beyond the end of a piece count 0. The encoder runs once for both terms. Samples are
/// walked in blocks that stay in cache; memory is taken once, for more steps ahead when they are
/// first asked for.
template <class Scalar>
class JointObjective {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  struct Value {
    double v_r = 0.0;  ///< V_R [score^2]
    double v_p = 0.0;  ///< V_P [score^2]
    double v_w = 0.0;  ///< V_W, sum of all squared weights [-]

    /// What `terms` minimise, without the weight w.
    double of(const Terms& terms) const {
      // eq. (5a)
      return (terms.v_r ? v_r : 0.0) + (terms.v_p ? v_p : 0.0) + terms.weight_decay * v_w;
    }
  };

  /// @param networks  shapes; outlives the objective
  /// @throws std::invalid_argument if shapes do not fit, or no piece is longer than n frames
  JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data);

  /// @param theta    parameters                                            [P]
  /// @param d_theta  out: derivative of the sum of `terms`; null: not wanted   [P]
  /// @param terms    what the derivative is of
  /// @return all values, whatever `terms` leaves out
  Value evaluate(const Vector& theta, Vector* d_theta, const Terms& terms = Terms());

  /// Kronecker factors of all layers, in the order of theta, of w times `terms` without its weight decay.
  /// @param rng  draws the errors at the outputs: +1 or -1 with equal probability
  LayerFactors<Scalar> factors(const Vector& theta, const Terms& terms, std::mt19937_64* rng);

  /// @return features of all images at the last evaluate()  [feature_dim x M]
  const Matrix& features() const { return features_; }
  /// @return root of the mean squared distance of the last evaluate()'s features to their mean
  double featureSpread() const {
    return std::sqrt(static_cast<double>(
        (features_.colwise() - features_.rowwise().mean()).squaredNorm() / features_.cols()));
  }
  /// @return w
  double weight() const { return weight_; }
  /// @return number of one-step predictions
  Eigen::Index numPredictions() const { return static_cast<Eigen::Index>(targets_.size()); }

 private:
  double squaredWeights(const Scalar* theta) const;
  void addDecay(const Scalar* theta, double price, Scalar* d_theta) const;
  void encode(const Scalar* theta, Eigen::Index block);
  void backwardThroughEncoder(const Scalar* theta, Eigen::Index block, Scalar* d_theta);
  Value decodeBlock(const Scalar* theta, Eigen::Index block, const Terms& terms, Scalar* d_theta);
  void reserve(int num_steps);
  void drawErrors(Eigen::Index num_images, Eigen::Index columns, Scalar step_weight);

  Eigen::Index blocksOf(Eigen::Index frames) const;
  Eigen::Index blockBegin(Eigen::Index block) const;
  Eigen::Index blockSize(Eigen::Index block) const;

  const Networks<Scalar>& networks_;
  TrainingData<Scalar> data_;
  double weight_ = 1.0;
  std::vector<Eigen::Index> targets_;       // frames that are predicted one step ahead, ascending
  std::vector<Eigen::Index> piece_end_;     // of each target: first frame that is not in its piece
  std::vector<Eigen::Index> block_target_;  // first target of each block, and the end
  Matrix features_;                         // z of all images         [feature_dim x M]
  Matrix d_features_;                       // dV/dz                   [feature_dim x M]
  // Of the blocks between the last one encoded and the first one whose dV/dz is not complete, in
  // turn: they stay in cache, however many frames there are.
  std::vector<typename Mlp<Scalar>::Tape> encoder_tapes_;
  typename Mlp<Scalar>::Tape decoder_tape_;
  RollOut<Scalar> roll_out_;  // of the block's targets
  Matrix d_codes_;   // dV/dz: of the block, then of the predicted z of its targets, step by step
  Matrix residual_;  // of their decoded scores
  std::mt19937_64* error_rng_ = nullptr;  // not null: errors are drawn, see factors()
};

extern template class JointObjective<float>;
extern template class JointObjective<double>;

}  // namespace ddm
