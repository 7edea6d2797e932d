// Gaussian processes as moment matching needs them: one per output, on common inputs; the kernel.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace ddm::pilco {

/// Hyper-parameters of E independent GPs with ARD squared-exponential covariance. Natural
/// logarithms, so that any real number is valid.
struct Hyperparameters {
  Eigen::MatrixXd log_length_scales;  ///< [D x E]
  Eigen::VectorXd log_signal_std;     ///< [E]
  Eigen::VectorXd log_noise_std;      ///< [E]
};

/// A trained GP: what the predictive distribution at a (Gaussian) input is computed from.
///
///   k_a(x, x') = sf_a^2 exp(-1/2 (x - x')^T Lambda_a^-1 (x - x')),   beta_a = A_a^-1 y_a
///
/// Full GP: A_a = K_a + sn_a^2 I on the training inputs. FITC: inputs are the inducing inputs Z,
/// and `inverse` stands for Kmm^-1 - B^-1, so that the formulas of the moments are the same for
/// both.
struct GpModel {
  Eigen::MatrixXd inputs;  ///< one per column                 [D x n]
  Hyperparameters hyperparameters;
  Eigen::MatrixXd beta;                  ///<                  [n x E]
  std::vector<Eigen::MatrixXd> inverse;  ///< A_a^-1, symmetric  E times [n x n]; empty: a
                                         ///< deterministic function (the RBF policy)

  int inputDim() const { return static_cast<int>(inputs.rows()); }
  int outputDim() const { return static_cast<int>(beta.cols()); }
  int numPoints() const { return static_cast<int>(inputs.cols()); }
};

/// A Gaussian N(mean, covariance).
struct Gaussian {
  Eigen::VectorXd mean;        ///< [D]
  Eigen::MatrixXd covariance;  ///< [D x D]
};

/// k(a, b) = signal_std^2 exp(-1/2 sum_d ((a_d - b_d) / length_scales_d)^2) of all pairs.
///
/// The differences are formed before they are squared: |a|^2 - 2 a b + |b|^2 would lose half of the
/// digits where points lie close together.
/// @param a              one input per column                                        [D x n_a]
/// @param b              one input per column                                        [D x n_b]
/// @param length_scales  in units of the inputs                                            [D]
/// @param signal_std     in units of the output
/// @return               row i, column j: k(a_i, b_j)                              [n_a x n_b]
/// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
Eigen::MatrixXd squaredExponential(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                   const Eigen::VectorXd& length_scales, double signal_std);

}  // namespace ddm::pilco
