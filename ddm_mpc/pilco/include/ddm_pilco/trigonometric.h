// Moments of sines and cosines of Gaussian angles, and features of a state with angles.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_pilco/moments.h"

namespace ddm::pilco {

struct SineCovarianceGradient {
  double mean_a = 0.0;
  double mean_b = 0.0;
  double variance = 0.0;  ///< in either variance
  double covariance = 0.0;
};

/// cov(sin a, sin b) for a ~ N(m_a, v_a), b ~ N(m_b, v_b), cov(a, b) = c:
///
///   (p cos(m_a - m_b) - r cos(m_a + m_b)) / 2,   p = q (e^c - 1),  r = q (e^-c - 1),
///   q = exp(-(v_a + v_b) / 2)
///
/// A cosine is a sine whose mean is pi/2 greater. For a = b, c is the variance.
/// @param gradient  (optional) out; the five arguments count as independent
double sineCovariance(double mean_a, double mean_b, double variance_a, double variance_b,
                      double covariance, SineCovarianceGradient* gradient = nullptr);

/// y = [x_kept, e_1 sin x_i1, e_1 cos x_i1, e_2 sin x_i2, e_2 cos x_i2, ...] for x ~ N(m, s)
/// (Deisenroth, 2010, Appendix A.1). With v the variance of an angle:
///
///   E[e sin x] = e exp(-v/2) sin m,                      E[e cos x] = e exp(-v/2) cos m
///   gain: row i, sine column e exp(-v/2) cos m,  cosine column -e exp(-v/2) sin m, otherwise 0
///
/// and covariances by sineCovariance(). Without angles it picks the kept entries.
class Augmentation {
 public:
  /// @param input_dim  D
  /// @param kept       indices of entries that are passed on as they are, may be empty
  /// @param angles     indices i_1, i_2, ... [rad], may be empty
  /// @param scales     e_1, e_2, ...; empty: 1 each
  /// @throws std::invalid_argument for an index outside of 0 ... D - 1, no output at all, or
  ///         another number of scales than of angles
  Augmentation(int input_dim, std::vector<int> kept, std::vector<int> angles,
               std::vector<double> scales = {});

  int inputDim() const { return input_dim_; }
  int outputDim() const;

  /// Value for a known x, e.g. a measurement.
  Eigen::VectorXd value(const Eigen::VectorXd& x) const;

  /// @throws std::invalid_argument if the input is not of dimension D
  Moments predict(const Gaussian& input) const;

  /// Vector-Jacobian product of predict() at the same input.
  /// @return dJ/dm, dJ/ds (symmetric)
  /// @throws std::invalid_argument if sizes do not fit
  Gaussian backward(const Gaussian& input, const Moments& d_output) const;

 private:
  int input_dim_;
  std::vector<int> kept_;
  std::vector<int> angles_;
  std::vector<double> scales_;
};

/// All entries that are no angles, in their order, then sine and cosine of the angles: what the GP
/// and the policy see of a state.
Augmentation replaceAngles(int input_dim, const std::vector<int>& angles);

}  // namespace ddm::pilco
