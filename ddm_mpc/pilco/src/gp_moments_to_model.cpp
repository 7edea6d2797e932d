// Derivatives of matched moments in the GP itself: centres, weights and length-scales.
// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <stdexcept>

#include "ddm_pilco/gp_moments.h"

namespace ddm {
namespace pilco {

void GpMoments::backwardToModel(const Tape& tape, const Moments& d_output,
                                GpGradient* d_model) const {
  const int dim = model_.inputDim();
  const int n = model_.numPoints();
  const int outputs = model_.outputDim();
  requireSize(d_output, dim, outputs, "gp moments");
  if (!model_.inverse.empty()) {
    throw std::invalid_argument("gp moments: no derivatives in a model with model uncertainty");
  }
  if (d_model->inputs.rows() != dim || d_model->inputs.cols() != n || d_model->beta.rows() != n ||
      d_model->beta.cols() != outputs || d_model->log_length_scales.rows() != dim ||
      d_model->log_length_scales.cols() != outputs) {
    throw std::invalid_argument("gp moments: the gradient has other sizes than the model");
  }
  meanToModel(tape, d_output, d_model);
  for (int b = 0; b < outputs; ++b) {
    for (int a = 0; a <= b; ++a) {
      const double d_sum = a == b ? d_output.covariance(a, a)
                                  : d_output.covariance(a, b) + d_output.covariance(b, a);
      pairToModel(a, b, d_sum, tape, d_model);
    }
  }
}

/// M and V in the notation of backward(), with d Lambda_dd = 2 l_d^2 d log l_d:
///
///   dJ/dX_i = p_i B nu - g_i B z_i,   dJ/dbeta_i = q_i (mu + nu^T B z_i)
///   dJ/dlog l_d = 2 l_d^2 [dJ/ds]_dd + sum g_i
void GpMoments::meanToModel(const Tape& tape, const Moments& d_output, GpGradient* d_model) const {
  const Eigen::VectorXd d_mean = meanAdjoint(tape, d_output);
  const Eigen::MatrixXd z = (model_.inputs.colwise() - tape.input.mean).transpose();
  for (int a = 0; a < model_.outputDim(); ++a) {
    const Eigen::MatrixXd& B = tape.inverse_widths[a];
    const auto q = tape.kernel_means.col(a);
    const Eigen::VectorXd terms = q.cwiseProduct(model_.beta.col(a));
    const Eigen::MatrixXd B_z = z * B;  // in rows
    const Eigen::VectorXd B_nu = B * d_output.gain.col(a);
    const Eigen::VectorXd gain = B_z.transpose() * terms;
    const Eigen::VectorXd d_terms = d_mean[a] + (z * B_nu).array();
    const Eigen::VectorXd g = terms.cwiseProduct(d_terms);

    d_model->inputs += B_nu * terms.transpose() - B_z.transpose() * g.asDiagonal();
    d_model->beta.col(a) += q.cwiseProduct(d_terms);
    const Eigen::VectorXd d_widths =
        0.5 * (B_z.cwiseProduct(B_z).transpose() * g - g.sum() * B.diagonal()) -
        B_nu.cwiseProduct(gain);
    d_model->log_length_scales.col(a).array() +=
        2.0 * d_widths.array() / precisions_.col(a).array() + g.sum();
  }
}

/// The double sum of S_ab, with u_i and v_j as in predictPair() and y_ij = T (u_i + v_j) - z_i:
///
///   dJ/dX_i = dJ/dS_ab Lambda_a^-1 sum_j P_ij y_ij,   dJ/dbeta_a = dJ/dS_ab Q beta_b
///   dJ/dlog l_ad = dJ/dS_ab l_ad^-2 sum_ij P_ij (T_dd + y_ijd^2)
///
/// and the same for b with the roles of i and j exchanged; for a = b both parts add up.
void GpMoments::pairToModel(int a, int b, double d_sum, const Tape& tape,
                            GpGradient* d_model) const {
  const Pair pair = pairTerms(a, b, tape.input.covariance);
  if (!pair.valid) {
    d_model->beta.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const Eigen::MatrixXd& T = pair.inner;
  const Eigen::MatrixXd z = (model_.inputs.colwise() - tape.input.mean).transpose();
  const Eigen::MatrixXd u = z * precisions_.col(a).asDiagonal();
  const Eigen::MatrixXd v = z * precisions_.col(b).asDiagonal();
  const Eigen::MatrixXd T_u = u * T;  // in rows
  const Eigen::MatrixXd T_v = v * T;
  const Eigen::MatrixXd y_a = T_u - z;
  const Eigen::MatrixXd y_b = T_v - z;
  const double log_scale = log_signal_variance_[a] + log_signal_variance_[b] - 0.5 * pair.log_det_R;
  Eigen::MatrixXd Q = T_u * v.transpose();
  Q.colwise() += 0.5 * y_a.cwiseProduct(u).rowwise().sum();
  Q.rowwise() += 0.5 * y_b.cwiseProduct(v).rowwise().sum().transpose();
  Q = (Q.array() + log_scale).exp();
  const Eigen::MatrixXd P = model_.beta.col(a).asDiagonal() * Q * model_.beta.col(b).asDiagonal();
  const Eigen::VectorXd rows = P.rowwise().sum();
  const Eigen::VectorXd columns = P.colwise().sum().transpose();

  d_model->beta.col(a) += d_sum * (Q * model_.beta.col(b));
  d_model->beta.col(b) += d_sum * (Q.transpose() * model_.beta.col(a));
  const auto addSide = [&](int output, const Eigen::MatrixXd& own, const Eigen::VectorXd& own_sum,
                           const Eigen::MatrixXd& other, const Eigen::VectorXd& other_sum,
                           const Eigen::MatrixXd& other_weighted) {
    const Eigen::MatrixXd sum_y = own_sum.asDiagonal() * own + other_weighted;
    d_model->inputs += d_sum * (sum_y * precisions_.col(output).asDiagonal()).transpose();
    const Eigen::VectorXd sum_squares =
        (own.cwiseProduct(sum_y + other_weighted)).colwise().sum().transpose() +
        other.cwiseProduct(other).transpose() * other_sum;
    d_model->log_length_scales.col(output) +=
        d_sum * precisions_.col(output).cwiseProduct(rows.sum() * T.diagonal() + sum_squares);
  };
  addSide(a, y_a, rows, T_v, columns, P * T_v);
  addSide(b, y_b, columns, T_u, rows, P.transpose() * T_u);
}

}  // namespace pilco
}  // namespace ddm
