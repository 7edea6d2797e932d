// The squared-exponential covariance with one length-scale for each input (ARD).
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/gp_model.h"

#include <cmath>

namespace ddm::pilco {
namespace {

/// Beyond this distance the covariance, 1e-100 of the signal's variance, is zero: products of such
/// numbers would be denormal, and a processor takes a hundred times as long for those.
constexpr double kFarthest = 460.0;

}  // namespace

Eigen::MatrixXd squaredExponential(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                   const Eigen::VectorXd& length_scales, double signal_std) {
  eigen_assert(a.rows() == length_scales.size() && b.rows() == length_scales.size());
  // One contiguous column for each coordinate, so that a column of k is one vectorised loop.
  const Eigen::MatrixXd scaled_a = (length_scales.cwiseInverse().asDiagonal() * a).transpose();
  const Eigen::MatrixXd scaled_b = length_scales.cwiseInverse().asDiagonal() * b;
  const double log_signal_variance = 2.0 * std::log(signal_std);
  Eigen::MatrixXd k(a.cols(), b.cols());
  Eigen::ArrayXd squared_distance(a.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    squared_distance.setZero();
    for (Eigen::Index d = 0; d < a.rows(); ++d) {
      squared_distance += (scaled_a.col(d).array() - scaled_b(d, j)).square();
    }
    k.col(j) = (squared_distance < kFarthest)
                   .select((log_signal_variance - 0.5 * squared_distance).exp(), 0.0);
  }
  return k;
}

}  // namespace ddm::pilco
