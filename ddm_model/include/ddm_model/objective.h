// Joint objective V_R + V_P of the deep dynamical model and its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "ddm_model/data_set.h"
#include "ddm_model/networks.h"
#include "ddm_model/pca.h"
#include "ddm_model/roll_out.h"
#include "ddm_model/schedule.h"

namespace ddm {

/// What the objective is computed from: PCA scores and torques of a data set.
template <class Scalar>
struct TrainingData {
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>
      scores;                     ///< all frames, then the goal if there is one  [pca_dim x M]
  Eigen::MatrixXd torques;        ///< [N m]                               [torque_dim x N]
  std::vector<Segment> segments;  ///< no prediction straddles two of them
};

inline TrainingData<float> makeTrainingData(const DataSet& data, const Pca& pca) {
  return {pca.project(data), data.torques(), data.segments()};
}

/// V = w (V_R + V_P) with (paper, eq. 5a)
///
///   V_R = sum_t |s_t - g(g^-1(s_t))|^2     all images and the goal                 eqs. (1, 5c)
///   V_P = sum_t |s_{t+1} - g(f(h_n))|^2    frames with n + d before them in their  eqs. (4, 5b)
///                                          segment
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
/// Targets beyond the end of a segment count 0. The encoder runs once for both terms.
///
/// V is a sum over parts of up to 128 images, whose activations stay in cache. Parts are independent: each encodes the
/// few images before its first one again. Up to eight lanes of parts run in parallel and are added in a fixed order, so the
/// result does not depend on the number of threads. Memory is taken once, for more steps ahead when they are first asked for.
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
  /// @throws std::invalid_argument if shapes do not fit
  JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data);

  /// @param theta    parameters                                            [P]
  /// @param d_theta  out: derivative of the sum of `terms`; null: not wanted   [P]
  /// @param terms    what the derivative is of
  /// @return all values, whatever `terms` leaves out
  Value evaluate(const Vector& theta, Vector* d_theta, const Terms& terms = Terms());

  /// Kronecker factors of all layers, in the order of theta, of w times `terms` without its weight decay.
  /// Images that two parts encode count twice in those of the encoder.
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
  Eigen::Index numPredictions() const;
  /// @throws std::invalid_argument if there are none: no segment is longer than n + d frames
  void requirePredictions() const;

 private:
  /// Images [begin, end), with those from `first` on to predict them from. Frames are counted from `first`.
  struct Part {
    Eigen::Index first, begin, end;
    std::vector<Eigen::Index> targets;  // frames that are predicted one step ahead
    // Of each target: the first frame that is not in its segment.
    std::vector<Eigen::Index> segment_end;
  };

  /// Where parts are computed one after the other: their sum, and memory that each of them uses.
  struct Lane {
    explicit Lane(const PredictionModel<Scalar>& f) : roll_out(f) {}

    Value value;
    Vector d_theta;                // of V / 2
    LayerFactors<Scalar> factors;  // of all layers in the order of theta; empty: not wanted
    typename Mlp<Scalar>::Tape encoder_tape;
    typename Mlp<Scalar>::Tape decoder_tape;
    RollOut<Scalar> roll_out;  // of the part's targets
    Matrix d_features;         // dV/dz of the part's images
    Matrix d_codes;            // dV/dz of what is decoded: images, then predictions step by step
    Matrix residual;           // of their decoded scores
  };

  void reserve(int num_steps);
  LayerFactors<Scalar> zeroFactors() const;
  void sumOverParts(const Vector& theta, const Terms& terms, bool gradient,
                    const std::uint64_t* error_seed);
  void forward(const Part& part, const Scalar* theta, const Terms& terms, Lane* lane);
  void backward(const Part& part, const Scalar* theta, const Terms& terms, Lane* lane) const;
  static void drawErrors(const Part& part, int steps, std::mt19937_64 rng, Lane* lane);

  const Networks<Scalar>& networks_;
  TrainingData<Scalar> data_;
  double weight_ = 1.0;
  std::vector<Part> parts_;
  std::vector<Lane> lanes_;
  Matrix features_;  // z of all images  [feature_dim x M]
};

extern template class JointObjective<float>;
extern template class JointObjective<double>;

}  // namespace ddm
