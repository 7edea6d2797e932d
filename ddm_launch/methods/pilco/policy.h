// PILCO's policy: an RBF network whose output is squashed by two sines.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "pilco/gp_moments.h"

namespace ddm::pilco {

/// u = u_max (9 sin x + sin 3x) / 8 for each entry: a wave with flat tops in [-u_max, u_max] and
/// slope 3/2 u_max at 0 (Deisenroth, Fox and Rasmussen, 2015, Sec. 5). Deisenroth (2010) uses a
/// single sine. For x ~ N(m, s), w_1 = 9/8, w_3 = 1/8:
///
///   M_i  = u_max_i sum_k w_k exp(-k^2 s_ii / 2) sin(k m_i)
///   S_ij = u_max_i u_max_j sum_kl w_k w_l cov(sin k x_i, sin l x_j)
///   gain: diagonal, u_max_i sum_k w_k k exp(-k^2 s_ii / 2) cos(k m_i)
///
/// @param max_control  u_max > 0, one entry per control input                  [U]
Moments squash(const Gaussian& x, const Eigen::VectorXd& max_control);

/// Vector-Jacobian product of squash() at the same input. Only the diagonal of dJ/dV is used,
/// because the gain is diagonal.
Gaussian squashBackward(const Gaussian& x, const Eigen::VectorXd& max_control,
                        const Moments& d_output);

/// u = squash(pi(x)) with an RBF network pi:
///
///   pi(x) = sum_i beta_i k(c_i, x),  beta = (K + 0.01^2 I)^-1 targets
///
/// k is the squared-exponential covariance with signal standard deviation 1 (Deisenroth, 2010: an
/// RBF network as the mean of a GP). The moments of pi(x) are those of a GP without model
/// uncertainty; 1e-6 is added to the diagonal of S. pi(x) is approximated by a Gaussian; the gain of
/// u is the gain of pi times the diagonal gain of the squashing. Parameters: log length-scales
/// [D x U], centres [nc x D], targets [nc x U], each by columns. The standard deviations of signal
/// and noise are fixed.
class RbfPolicy {
 public:
  static constexpr double kNoiseVariance = 1e-4;
  static constexpr double kJitter = 1e-6;

  /// All parameters are 0 until setParameters() is called.
  /// @param max_control  u_max, one entry per control input                    [U]
  RbfPolicy(int input_dim, int num_centres, Eigen::VectorXd max_control);

  int inputDim() const { return input_dim_; }
  int outputDim() const { return static_cast<int>(max_control_.size()); }

  /// Returns a copy, so that setParameters() does not change the initial parameters of a search.
  Eigen::VectorXd parameters() const { return parameters_; }

  /// Accepts parameters that are not finite or make K lose positive definiteness; all predictions
  /// are then NaN.
  void setParameters(const Eigen::VectorXd& parameters);

  Moments predict(const Gaussian& input) const;

  /// The moments of pi(x), before the squashing.
  /// @param tape  (optional) out: record of the network
  Moments predictUnsquashed(const Gaussian& input, GpMoments::Tape* tape = nullptr) const;

  /// Vector-Jacobian product of predict() at the same input.
  /// @pre predict() is finite at the input
  /// @param d_output      dJ/dM, dJ/dS, dJ/dV
  /// @param d_parameters  dJ/d(parameters) is ADDED to it
  /// @return              dJ/dm, dJ/ds (symmetric)
  Gaussian backward(const Gaussian& input, const Moments& d_output,
                    Eigen::VectorXd* d_parameters) const;

  /// The control input for known features: the mean of predict() with zero covariance.
  Eigen::VectorXd control(const Eigen::VectorXd& features) const;

  /// Concatenates the parts of the parameter vector.
  /// @param log_length_scales  one column per output                  [D x U]
  /// @param centres            one centre per column                  [D x nc]
  /// @param targets            one column per output                  [nc x U]
  static Eigen::VectorXd packParameters(const Eigen::MatrixXd& log_length_scales,
                                        const Eigen::MatrixXd& centres,
                                        const Eigen::MatrixXd& targets);

 private:
  Eigen::MatrixXd throughBeta(GpGradient* d_network) const;

  int input_dim_;
  int num_centres_;
  Eigen::VectorXd max_control_;
  Eigen::VectorXd parameters_;
  std::vector<Eigen::MatrixXd> kernels_;                     // K_u            U times [nc x nc]
  std::vector<Eigen::LLT<Eigen::MatrixXd>> factorisations_;  // of K_u + 1e-4 I
  std::unique_ptr<GpMoments> network_;
};

}  // namespace ddm::pilco
