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

/// Input of the objective: PCA scores and torques of a data set.
template <class Scalar>
struct TrainingData {
  /// Scores of all samples, then of the goal image if there is one  [pca_dim x M]
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> scores;
  Eigen::MatrixXd torques;        ///< [N m]                               [torque_dim x N]
  std::vector<Segment> segments;  ///< no prediction spans two of them
};

inline TrainingData<float> makeTrainingData(const DataSet& data, const Pca& pca) {
  return {pca.project(data), data.torques(), data.segments()};
}

/// Joint objective V = w (V_R + V_P) (paper, eq. 5a) on PCA scores s, with
///
///   V_R = sum_t |s_t - g(g^-1(s_t))|^2     eqs. (1, 5c), over all images and the goal image
///   V_P = sum_t |s_{t+1} - g(f(h_n))|^2    eqs. (4, 5b), over all samples with n
///                                          predecessors in their segment
///
/// With Terms::prediction_steps k > 1, V_P is the mean over predictions 1 ... k steps ahead, each
/// computed from the one before:
///
///   V_P = 1/k sum_t sum_{j=1..k} |s_{t+j} - g(z_{t+j|t})|^2
///
/// where a target beyond the end of its segment counts 0. With Terms::weight_decay w_d > 0, V also
/// has the term w_d V_W, where V_W is the sum of all squared weights without the biases. Among the
/// networks that fit few data, it selects smooth ones.
///
/// Deviation: the paper's V counts pixels. The part of an image outside the PCA basis is a constant
/// that no parameter changes. The weight w = 1 / sum_t |s_t|^2 makes V about 1 for a useless model.
///
/// The implementation splits the sum into parts of up to 128 images, whose activations fit in the
/// cache. Each part encodes the few images before its first one again, so that parts are
/// independent. Up to eight lanes of parts run in parallel. Their sums are added in a fixed order,
/// so that the result does not depend on the number of threads. The encoder runs once for both
/// terms. Memory is allocated once, and again only when more prediction steps are needed.
template <class Scalar>
class JointObjective {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  struct Value {
    double v_r = 0.0;  ///< V_R [score^2]
    double v_p = 0.0;  ///< V_P [score^2]
    double v_w = 0.0;  ///< V_W, sum of all squared weights [-]

    /// @return value that `terms` selects, without the factor w
    double of(const Terms& terms) const {
      // eq. (5a)
      return (terms.v_r ? v_r : 0.0) + (terms.v_p ? v_p : 0.0) + terms.weight_decay * v_w;
    }
  };

  /// @param networks  shapes of the networks; must outlive the objective
  /// @param data      scores and torques; segments in order of time
  JointObjective(const Networks<Scalar>& networks, TrainingData<Scalar> data);

  /// @param theta    parameters                                                              [P]
  /// @param d_theta  out: gradient of Value::of(terms); null: skip                           [P]
  /// @param terms    terms of the gradient
  /// @return         V_R, V_P and V_W, also those that `terms` excludes
  Value evaluate(const Vector& theta, Vector* d_theta, const Terms& terms = Terms());

  /// Computes the Kronecker factors of all layers, in the order of theta, for w times `terms`
  /// without weight decay. An image that two parts encode counts twice in the factors of the
  /// encoder.
  /// @param rng  draws the errors at the outputs: +1 or -1 with equal probability
  LayerFactors<Scalar> factors(const Vector& theta, const Terms& terms, std::mt19937_64* rng);

  /// @return features of all images at the last evaluate()  [feature_dim x M]
  const Matrix& features() const { return features_; }
  /// @return w
  double weight() const { return weight_; }
  /// @return number of one-step predictions
  Eigen::Index numPredictions() const;
  /// @throws std::invalid_argument if there are none, as no segment is longer than n samples
  void requirePredictions() const;

 private:
  /// Images [begin, end), and before them the images from `first` on, from which the first of them
  /// are predicted. Indices of samples count from `first`.
  struct Part {
    Eigen::Index first, begin, end;
    std::vector<Eigen::Index> targets;  // samples predicted one step ahead
    // For each target, the first sample after its segment.
    std::vector<Eigen::Index> segment_end;
  };

  /// Parts that are computed one after the other: their sum, and the memory that they share.
  struct Lane {
    explicit Lane(const PredictionModel<Scalar>& f) : roll_out(f) {}

    Value value;
    Vector d_theta;                // gradient of V / 2
    LayerFactors<Scalar> factors;  // all layers in the order of theta; empty: not computed
    typename Mlp<Scalar>::Tape encoder_tape;
    typename Mlp<Scalar>::Tape decoder_tape;
    RollOut<Scalar> roll_out;  // rollouts to the targets of the part
    Matrix d_features;         // dV/dz of the images of the part
    Matrix d_codes;   // dV/dz of all decoded features: images, then predictions step by step
    Matrix residual;  // decoded scores minus true scores, in the same order
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
