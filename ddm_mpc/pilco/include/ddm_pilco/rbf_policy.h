// RBF-network policy: the mean of a GP with free pseudo-data.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "ddm_pilco/gp_moments.h"
#include "ddm_pilco/policy.h"

namespace ddm::pilco {

/// pi(x) = sum_i beta_i k(c_i, x),  beta = (K + 0.01^2 I)^-1 targets, with the squared-exponential
/// k of signal standard deviation 1 (Deisenroth, 2010: an RBF network as the mean of a GP).
///
/// The moments are those of a GP without model uncertainty; 1e-6 is added to the diagonal of S.
/// Parameters: log length-scales [D x U], centres [nc x D], targets [nc x U], each by columns. The
/// signal and noise standard deviations are fixed and not among them.
class RbfPolicy : public Policy {
 public:
  static constexpr double kNoiseVariance = 1e-4;
  static constexpr double kJitter = 1e-6;

  /// All parameters are 0 until setParameters().
  /// @throws std::invalid_argument if a size is < 1
  RbfPolicy(int input_dim, int output_dim, int num_centres);

  int inputDim() const override { return input_dim_; }
  int outputDim() const override { return output_dim_; }

  Eigen::VectorXd parameters() const override { return parameters_; }

  /// Parameters that are not finite, or with which K loses positive definiteness, are accepted; all
  /// predictions are NaN then.
  void setParameters(const Eigen::VectorXd& parameters) override;

  Moments predict(const Gaussian& input) override;
  Gaussian backward(const Gaussian& input, const Moments& d_output,
                    Eigen::VectorXd* d_parameters) override;

  /// The flat vector from its parts.
  /// @param log_length_scales                                         [D x U]
  /// @param centres            one per column                         [D x nc]
  /// @param targets                                                   [nc x U]
  static Eigen::VectorXd packParameters(const Eigen::MatrixXd& log_length_scales,
                                        const Eigen::MatrixXd& centres,
                                        const Eigen::MatrixXd& targets);

 private:
  void addThroughBeta(GpGradient* d_network, Eigen::MatrixXd* d_targets) const;

  int input_dim_;
  int output_dim_;
  int num_centres_;
  Eigen::VectorXd parameters_;
  std::vector<Eigen::MatrixXd> kernels_;                     // K_u            U times [nc x nc]
  std::vector<Eigen::LLT<Eigen::MatrixXd>> factorisations_;  // of K_u + 1e-4 I
  std::unique_ptr<GpMoments> network_;
};

}  // namespace ddm::pilco
