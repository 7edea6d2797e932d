// The three networks of the deep dynamical model, and their places in the parameter vector theta.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "ddm_model/gp_mean.h"
#include "ddm_model/mlp.h"
#include "ddm_model/model_options.h"
#include "ddm_model/per_motor.h"

namespace ddm {

/// Prediction model f: one step in feature space (paper, eq. 2). The caller holds its parameters.
///
///   z_{t+1} = f(h_n; theta_P)
///   h_n     = [z_t, u_t, z_{t-1}, u_{t-1}, ..., z_{t-n+1}, u_{t-n+1}]
///
/// with u in units of max_torque. RollOut builds h_n. The output layer of the network is linear.
/// Deviations with model/predictor gp:
///  * f is z_t plus the network, which then learns only the change of z.
///  * h_n = [z_t, u_t, z_t - z_{t-1}, u_{t-1}, u_{t-2}, ..., u_{t-n+1}]. Features of successive images
///    are almost equal, and only their difference shows the motion. If the images are d samples late,
///    the two features do not yet show the whole effect of the last d + 2 torques, so n must be at
///    least d + 2.
///  * In a trained model, the mean of a Gaussian process replaces the network.
template <class Scalar>
class PredictionModel {
 public:
  using Matrix = typename Mlp<Scalar>::Matrix;

  /// @param num_centres  centres of the Gaussian process that f contains; 0: f contains a network
  /// @throws std::invalid_argument if max_torque has a wrong number of entries
  PredictionModel(const ModelOptions& options, int torque_dim, Eigen::Index num_centres = 0)
      : options_(options),
        torque_dim_(torque_dim),
        max_torque_(perMotor(options.max_torque, torque_dim, "model/max_torque")),
        network_(layerWidths(numFeatures() * options.feature_dim + options.order * torque_dim,
                             options.predictor_widths, options.feature_dim),
                 Mlp<Scalar>::Output::kLinear) {
    if (num_centres > 0) gp_.emplace(regressorDim(), featureDim(), num_centres);
  }

  int featureDim() const { return options_.feature_dim; }
  int torqueDim() const { return torque_dim_; }
  /// @return n, number of torques in h_n
  int order() const { return options_.order; }
  /// @return number of features in h_n; at most n
  int numFeatures() const { return options_.featureDifferences() ? std::min(order(), 2) : order(); }
  /// @return scale of the torques: f sees u / maxTorque() [N m]  [torque_dim]
  const Eigen::VectorXd& maxTorque() const { return max_torque_; }
  /// @return size of h_n
  int regressorDim() const { return network_.inputDim(); }

  /// @return the network within f
  const Mlp<Scalar>& network() const { return network_; }
  /// @return P_f, the number of parameters
  Eigen::Index numParams() const { return gp_ ? gp_->numParams() : network_.numParams(); }

  /// Prepares for many predictions with the same parameters  [P_f]
  void fixParameters(const Scalar* theta_p) {
    if (gp_) gp_->fixParameters(theta_p);
  }

  /// Replaces the previous feature in regressors by the difference, if f sees the difference.
  void toDifferences(Eigen::Ref<Matrix> regressors) const {
    if (!seesDifference()) return;
    features(1, regressors) = features(0, regressors) - features(1, regressors);
  }

  /// @param theta_p     parameters of f                                                      [P_f]
  /// @param regressors  one h_n per column; out: inputs of the network       [regressorDim() x N]
  /// @param tape        out: record for backward()
  /// @param predicted   out: z_{t+1}; must have this size already                [feature_dim x N]
  void forward(const Scalar* theta_p, Eigen::Ref<Matrix> regressors,
               typename Mlp<Scalar>::Tape* tape, Eigen::Ref<Matrix> predicted) const {
    toDifferences(regressors);
    if (gp_) {  // eq. (2)
      gp_->forward(theta_p, regressors, tape);
    } else {
      network_.forward(theta_p, regressors, tape);
    }
    predicted = tape->output();
    if (options_.featureDifferences()) predicted += features(0, regressors);
  }

  /// Vector-Jacobian product of forward(). Consumes the tape.
  /// @param theta_p       parameters of the forward pass                                     [P_f]
  /// @param d_predicted   dV/dz_{t+1}                                            [feature_dim x N]
  /// @param d_theta_p     dV/d theta_P is ADDED to it; null: skip. A Gaussian process has none [P_f]
  /// @param d_regressors  out: dV/dh_n in its first N columns              [regressorDim() x >= N]
  void backward(const Scalar* theta_p, typename Mlp<Scalar>::Tape* tape,
                const Eigen::Ref<const Matrix>& d_predicted, Scalar* d_theta_p,
                Matrix* d_regressors) const {
    if (gp_) {
      gp_->backward(theta_p, tape, d_predicted, d_regressors);
    } else {
      network_.backward(theta_p, tape, d_predicted, d_theta_p, d_regressors);
    }
    auto d_h = d_regressors->leftCols(d_predicted.cols());
    if (seesDifference()) {
      features(0, d_h) += features(1, d_h);
      features(1, d_h) *= Scalar(-1);
    }
    if (options_.featureDifferences()) features(0, d_h) += d_predicted;
  }

 private:
  bool seesDifference() const { return options_.featureDifferences() && numFeatures() > 1; }
  /// @return rows of the feature `lag` steps before the current one
  template <class Regressors>
  auto features(int lag, Regressors& regressors) const {
    return regressors.middleRows(lag * (featureDim() + torque_dim_), featureDim());
  }

  ModelOptions options_;
  int torque_dim_;
  Eigen::VectorXd max_torque_;
  Mlp<Scalar> network_;
  std::optional<GpMean<Scalar>> gp_;
};

/// g^-1, g and f, and their places in the flat vector theta = [theta_E, theta_D, theta_P].
///
///   z = g^-1(score; theta_E)   arctan after every layer, including the last (paper, Sec. 2.1)
///   score_hat = g(z; theta_D)  arctan after hidden layers; the output layer is linear
template <class Scalar>
struct Networks {
  PredictionModel<Scalar> prediction_model;

  /// @param num_centres  of the Gaussian process in f; 0: f is a network
  /// @throws std::invalid_argument if max_torque has a wrong number of entries
  Networks(const ModelOptions& options, int torque_dim, Eigen::Index num_centres = 0)
      : prediction_model(options, torque_dim, num_centres),
        encoder_(layerWidths(options.pca_dim, options.encoder_widths, options.feature_dim),
                 Mlp<Scalar>::Output::kArctan),
        decoder_(layerWidths(options.feature_dim, options.decoderWidths(), options.pca_dim),
                 Mlp<Scalar>::Output::kLinear) {}

  Eigen::Index numParams() const { return numOfAutoEncoder() + prediction_model.numParams(); }
  /// @return number of parameters in theta_E and theta_D
  Eigen::Index numOfAutoEncoder() const { return encoder().numParams() + decoder().numParams(); }
  const Mlp<Scalar>& encoder() const { return encoder_; }
  const Mlp<Scalar>& decoder() const { return decoder_; }
  const Mlp<Scalar>& f() const { return prediction_model.network(); }

  /// @return address of theta_E, theta_D or theta_P in theta (const or not)
  template <class Pointer>
  Pointer encoderOf(Pointer theta) const {
    return theta;
  }
  template <class Pointer>
  Pointer decoderOf(Pointer theta) const {
    return theta + encoder().numParams();
  }
  template <class Pointer>
  Pointer predictorOf(Pointer theta) const {
    return theta + numOfAutoEncoder();
  }

 private:
  Mlp<Scalar> encoder_;  // g^-1: pca_dim ... feature_dim
  Mlp<Scalar> decoder_;  // g:    feature_dim ... pca_dim
};

/// Computes initial weights (paper, Sec. 2.3, "Initialization"). The auto-encoder is unfolded: each
/// encoder layer and the decoder layer that mirrors it form a pair, and the PCA of the encoder
/// layer's inputs initialises the pair,
///
///   encoder:  W = c B^T, b = -c B^T m        decoder:  W = B / c, b = m
///
/// with basis B and mean m of the inputs. The scale c gives the leading unit a standard deviation
/// of 0.3, where arctan is nearly linear. The output after arctan is the input of the next pair.
/// Random numbers initialise f, units beyond the rank of the inputs, and, if pca_start is false,
/// the whole auto-encoder.
/// @param scores     PCA scores of all images                       [pca_dim x M]
/// @param pca_start  false: the auto-encoder has random initial weights
/// @return           theta                                                    [P]
Eigen::VectorXd initialTheta(const Networks<double>& networks, const Eigen::MatrixXd& scores,
                             bool pca_start, std::mt19937_64* rng);

/// @return options of joinAutoEncoders() for `count` models with options `one`
ModelOptions joinedOptions(ModelOptions one, int count);

/// Joins the auto-encoders of several models of the same images. The joined feature contains their
/// features one after the other. The joined decoder returns the mean of their images.
/// @param one     options that the models share
/// @param thetas  parameters of each model, at least one                   [P or more]
/// @return        theta_E and theta_D for joinedOptions()
Eigen::VectorXd joinAutoEncoders(const ModelOptions& one,
                                 const std::vector<Eigen::VectorXd>& thetas);

}  // namespace ddm
