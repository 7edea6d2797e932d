// Exact moment matching: mean, covariance and gain of a GP at a Gaussian input, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pilco/gp.h"
#include "pilco/moments.h"

namespace ddm::pilco {

/// Derivatives of a scalar J with respect to the parameters of a GP without model uncertainty.
struct GpGradient {
  Eigen::MatrixXd inputs;             ///< [D x n]
  Eigen::MatrixXd beta;               ///< [n x E]
  Eigen::MatrixXd log_length_scales;  ///< [D x E]
};

/// Predictive distribution of E independent GPs at x ~ N(m, s) (Deisenroth and Rasmussen, 2011,
/// eqs. 14 to 23; Deisenroth, 2010, Sec. 2.3). With z_i = X_i - m:
///
///   q_ai  = sf_a^2 |s Lambda_a^-1 + I|^-1/2 exp(-1/2 z_i^T (s + Lambda_a)^-1 z_i)
///   M_a   = sum_i beta_ai q_ai
///   V_a   = sum_i beta_ai q_ai (s + Lambda_a)^-1 z_i
///   Q_ij  = k_a(X_i, m) k_b(X_j, m) |R|^-1/2 exp(1/2 w_ij^T R^-1 s w_ij)
///           R = s (Lambda_a^-1 + Lambda_b^-1) + I,  w_ij = Lambda_a^-1 z_i + Lambda_b^-1 z_j
///   S_ab  = beta_a^T Q beta_b - M_a M_b,  and for a = b:  + sf_a^2 - trace(A_a^-1 Q)
///
/// The last two terms are the model uncertainty. A model without `inverse` has no such terms. S
/// does not contain the observation noise. s may be singular or zero.
///
/// All results are NaN if the model or the input contains numbers that are not finite, or if s is
/// far from positive semi-definite.
class GpMoments {
 public:
  /// What backward() needs from predict(). The tape holds no [n x n] matrices, because predict()
  /// forms the derivatives of the double sums while it computes Q.
  struct Tape {
    Gaussian input;
    Eigen::MatrixXd kernel_means;                 ///< q_ai                   [n x E]
    std::vector<Eigen::MatrixXd> inverse_widths;  ///< (s + Lambda_a)^-1  E times [D x D]
    std::vector<Gaussian> d_sums;                 ///< derivatives of the double sum of each pair
                                                  ///< a <= b by m and s; b counts slower
    Eigen::VectorXd mean;                         ///< M                          [E]
  };

  /// @pre the shapes of the model fit each other (checked by eigen_assert)
  explicit GpMoments(GpModel model);

  const GpModel& model() const { return model_; }

  /// @param input  distribution of x                                  D entries
  /// @param tape   (optional) out: record for backward()
  Moments predict(const Gaussian& input, Tape* tape = nullptr) const;

  /// Vector-Jacobian product of predict().
  /// @param d_output  dJ/dM, dJ/dS, dJ/dV
  /// @param d_model   (optional) dJ/d inputs, beta, log length-scales are ADDED to it. This forms
  ///                  the matrix Q [n x n] and is meant for policies, which have few points and no
  ///                  model uncertainty
  /// @pre the result of predict() was finite
  /// @return          dJ/dm, dJ/ds; dJ/ds is symmetric: if s(p,q) and s(q,p) change by h, J changes
  ///                  by h (entry pq + entry qp)
  Gaussian backward(const Tape& tape, const Moments& d_output, GpGradient* d_model = nullptr) const;

 private:
  bool predictMeans(const Eigen::MatrixXd& z, const Eigen::MatrixXd& s, Moments* output,
                    Tape* tape) const;
  bool predictPair(int a, int b, const Eigen::MatrixXd& z, const Eigen::MatrixXd& s,
                   Moments* output, Tape* tape) const;
  void pairToModel(int a, int b, double d_sum, const Eigen::MatrixXd& z, const Eigen::MatrixXd& s,
                   GpGradient* d_model) const;

  GpModel model_;
  Eigen::MatrixXd precisions_;            // 1 / l^2                             [D x E]
  Eigen::VectorXd log_signal_variance_;   // log sf^2                                [E]
  std::vector<Eigen::MatrixXd> weights_;  // half of beta beta^T - A^-1    E times [n x n]
  bool finite_ = false;
};

}  // namespace ddm::pilco
