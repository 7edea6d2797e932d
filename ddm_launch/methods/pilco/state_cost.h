// Features of a state that contains angles, and the saturating cost of a state.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pilco/moments.h"

namespace ddm::pilco {

/// Derivatives of sineCovariance() with respect to its arguments.
struct SineCovarianceGradient {
  double mean_a = 0.0;
  double mean_b = 0.0;
  double variance = 0.0;  ///< with respect to either variance
  double covariance = 0.0;
};

/// cov(sin a, sin b) for a ~ N(m_a, v_a), b ~ N(m_b, v_b), cov(a, b) = c:
///
///   (p cos(m_a - m_b) - r cos(m_a + m_b)) / 2,   p = q (e^c - 1),  r = q (e^-c - 1),
///   q = exp(-(v_a + v_b) / 2)
///
/// The cosine of an angle is the sine of an angle whose mean is pi/2 greater. For a = b, c is the
/// variance.
/// @param gradient  (optional) out: derivatives; the five arguments count as independent
double sineCovariance(double mean_a, double mean_b, double variance_a, double variance_b,
                      double covariance, SineCovarianceGradient* gradient = nullptr);

/// y = [x_kept, sin x_i1, cos x_i1, sin x_i2, cos x_i2, ...] for x ~ N(m, s) (Deisenroth, 2010,
/// Appendix A.1). With v the variance of an angle:
///
///   E[sin x] = exp(-v/2) sin m,                      E[cos x] = exp(-v/2) cos m
///   gain: row i, sine column exp(-v/2) cos m,  cosine column -exp(-v/2) sin m, otherwise 0
///
/// and the covariances are sineCovariance(). Without angles, y consists of the kept entries.
class Augmentation {
 public:
  /// @param input_dim  D
  /// @param kept       indices of entries that y contains unchanged; may be empty
  /// @param angles     indices i_1, i_2, ... of angles [rad]; may be empty
  Augmentation(int input_dim, std::vector<int> kept, std::vector<int> angles);

  int inputDim() const { return input_dim_; }
  int outputDim() const;

  /// The value for a known x, e.g. a measurement.
  Eigen::VectorXd value(const Eigen::VectorXd& x) const;

  Moments predict(const Gaussian& input) const;

  /// Vector-Jacobian product of predict() at the same input.
  /// @return dJ/dm, dJ/ds (symmetric)
  Gaussian backward(const Gaussian& input, const Moments& d_output) const;

 private:
  int input_dim_;
  std::vector<int> kept_;
  std::vector<int> angles_;
};

/// All entries that are not angles, in their order, then sine and cosine of each angle. GP and
/// policy receive these features of a state.
Augmentation replaceAngles(int input_dim, const std::vector<int>& angles);

/// c(x) = 1 - exp(-1/2 (y - z)^T W (y - z)) (Deisenroth and Rasmussen, 2011) with the features y of
/// an Augmentation. y is approximated by a Gaussian N(m, s). With P_k = W (I + k s W)^-1:
///
///   E[c]         = 1 - |I + s W|^-1/2 exp(-1/2 (m - z)^T P_1 (m - z))
///   E[(1 - c)^2] = |I + 2 s W|^-1/2 exp(-(m - z)^T P_2 (m - z))
class StateCost {
 public:
  /// @param features  y(x)
  /// @param target    z                                                  [E]
  /// @param weight    W, symmetric and positive semi-definite        [E x E]
  StateCost(Augmentation features, Eigen::VectorXd target, const Eigen::MatrixXd& weight);

  int inputDim() const { return features_.inputDim(); }

  /// E[c].
  /// @param d_state  (optional) out: derivatives of E[c] by mean and covariance of x; symmetric
  double expected(const Gaussian& state, Gaussian* d_state = nullptr) const;

  /// var[c]. Values below 1e-12 are rounding errors and become 0.
  double variance(const Gaussian& state) const;

 private:
  Augmentation features_;
  Eigen::VectorXd target_;
  Eigen::MatrixXd weight_;
};

/// 1 - exp(-d^2 / (2 width^2)) with the distance d of the tip of a pendulum from its upright
/// position. The state is [dphi, phi]; phi = pi is upright.
/// @param length  length of the pendulum [m]
/// @param width   width of the cost [m]
StateCost pendulumCost(double length = 1.0, double width = 0.5);

}  // namespace ddm::pilco
