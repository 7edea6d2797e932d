// Exact moment matching: mean, covariance and gain of a GP at a Gaussian input, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/gp_moments.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

namespace ddm::pilco {
namespace {

/// The n x n matrix P_ij = w_ij c_j exp(f_i + g_j + u_i^T v_j), which is never stored.
struct ExponentialMatrix {
  Eigen::VectorXd f;               ///<                                      [n]
  Eigen::VectorXd g;               ///<                                      [n]
  Eigen::MatrixXd u;               ///< u_i in rows                      [n x D]
  Eigen::MatrixXd v;               ///< v_j in columns                   [D x n]
  Eigen::VectorXd column_weights;  ///< c                                    [n]
};

struct ExponentialSums {
  Eigen::VectorXd rows;     ///< sum_j P_ij                                  [n]
  Eigen::VectorXd columns;  ///< sum_i P_ij                                  [n]
  Eigen::MatrixXd moments;  ///< sum_i P_ij u_i in columns               [D x n]
};

/// PILCO spends nearly all of its computing time in this function. The exponent is clamped to
/// [-500, 709]: e^-500 is negligible, and products of smaller numbers could be denormal, which
/// processors compute a hundred times slower.
/// @param w  weights: one column if the weights of all columns are equal, else n columns, of which
///           only the lower triangle is used                       [n x 1 or n x n]
ExponentialSums exponentialSums(const ExponentialMatrix& matrix,
                                const Eigen::Ref<const Eigen::MatrixXd>& w) {
  const Eigen::Index rows = matrix.u.rows();
  const Eigen::Index cols = matrix.g.size();
  const bool same_columns = w.cols() == 1;
  ExponentialSums sums;
  sums.rows.setZero(rows);
  sums.columns.resize(cols);
  sums.moments.resize(matrix.u.cols(), cols);
  Eigen::VectorXd column(rows);  // a single column stays in the fastest cache
  for (Eigen::Index j = 0; j < cols; ++j) {
    const Eigen::Index n = same_columns ? rows : rows - j;
    const auto u = matrix.u.bottomRows(n);
    auto p = column.tail(n);
    p = matrix.f.tail(n);
    p.noalias() += u * matrix.v.col(j);
    p = (p.array() + matrix.g[j]).max(-500.0).min(709.0).exp() *
        w.col(same_columns ? 0 : j).tail(n).array() * matrix.column_weights[j];
    sums.rows.tail(n) += p;
    sums.columns[j] = p.sum();
    sums.moments.col(j).noalias() = u.transpose() * p;
  }
  return sums;
}

/// Terms of a pair of outputs that are the same for all points.
struct Pair {
  Eigen::MatrixXd inverse_R;  ///< R^-1 = (I + s P)^-1                       [D x D]
  Eigen::MatrixXd inner;      ///< T = R^-1 s, symmetric                     [D x D]
  double log_det_R = 0.0;
};

/// @param precision_sum  P = Lambda_a^-1 + Lambda_b^-1, a diagonal              [D]
/// @return               empty matrices if R has eigenvalues that are not positive
Pair pairTerms(const Eigen::VectorXd& precision_sum, const Eigen::MatrixXd& s) {
  // With C = P^1/2: R^-1 = C^-1 (I + C s C)^-1 C and T = C^-1 (I + C s C)^-1 (C s C) C^-1.
  const Eigen::VectorXd root = precision_sum.cwiseSqrt();
  const Eigen::VectorXd inverse_root = root.cwiseInverse();
  const Eigen::MatrixXd scaled = root.asDiagonal() * symmetricPart(s) * root.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> llt(Eigen::MatrixXd::Identity(s.rows(), s.cols()) + scaled);
  if (llt.info() != Eigen::Success) return {};
  return {inverse_root.asDiagonal() * llt.solve(Eigen::MatrixXd(root.asDiagonal())),
          symmetricPart(inverse_root.asDiagonal() * llt.solve(scaled) * inverse_root.asDiagonal()),
          2.0 * llt.matrixLLT().diagonal().array().log().sum()};
}

}  // namespace

GpMoments::GpMoments(GpModel model) : model_(std::move(model)) {
  const int outputs = model_.outputDim();
  eigen_assert(model_.numPoints() >= 1 && outputs >= 1 &&
               model_.beta.rows() == model_.numPoints() &&
               model_.hyperparameters.rows() == model_.inputDim() + 2 &&
               model_.hyperparameters.cols() == outputs &&
               (model_.inverse.empty() || static_cast<int>(model_.inverse.size()) == outputs));
  const Eigen::MatrixXd log_length_scales = model_.hyperparameters.topRows(model_.inputDim());
  precisions_ = (-2.0 * log_length_scales.array()).exp();
  log_signal_variance_ = 2.0 * model_.hyperparameters.row(model_.inputDim()).transpose();
  finite_ = model_.inputs.allFinite() && model_.beta.allFinite() && precisions_.allFinite() &&
            log_signal_variance_.allFinite() && (precisions_.array() > 0.0).all();

  // The double sum for one output is symmetric in its points. It is computed as twice the sum over
  // the lower triangle, with half the diagonal.
  weights_.resize(outputs);
  for (int a = 0; a < outputs; ++a) {
    Eigen::MatrixXd full = model_.beta.col(a) * model_.beta.col(a).transpose();
    if (!model_.inverse.empty()) full -= model_.inverse[a];
    finite_ = finite_ && full.allFinite();
    weights_[a] = full.triangularView<Eigen::StrictlyLower>();
    weights_[a].diagonal() = 0.5 * full.diagonal();
  }
}

Moments GpMoments::predict(const Gaussian& input, Tape* tape) const {
  const int dim = model_.inputDim();
  const int outputs = model_.outputDim();
  eigen_assert(input.mean.size() == dim && input.covariance.rows() == dim);
  const Moments invalid = constantMoments(dim, outputs, kNaN);
  if (tape != nullptr) *tape = {input, Eigen::MatrixXd(model_.numPoints(), outputs), {}, {}, {}};
  // NaN is rejected here, because some vectorised exponentials do not propagate NaN.
  if (!finite_ || !input.mean.allFinite() || !input.covariance.allFinite()) return invalid;

  const Eigen::MatrixXd z = (model_.inputs.colwise() - input.mean).transpose();
  Moments output = invalid;
  if (!predictMeans(z, input.covariance, &output, tape)) return invalid;
  for (int b = 0; b < outputs; ++b) {
    for (int a = 0; a <= b; ++a) {
      if (!predictPair(a, b, z, input.covariance, &output, tape)) return invalid;
    }
  }
  return output;
}

/// Computes M and V. Returns false if s + Lambda is not positive definite.
bool GpMoments::predictMeans(const Eigen::MatrixXd& z, const Eigen::MatrixXd& s, Moments* output,
                             Tape* tape) const {
  const int dim = model_.inputDim();
  for (int a = 0; a < model_.outputDim(); ++a) {
    // (s + Lambda)^-1 = L (I + L s L)^-1 L with L = Lambda^-1/2. No eigenvalue of I + L s L is
    // below 1.
    const Eigen::VectorXd root = precisions_.col(a).cwiseSqrt();
    const Eigen::LLT<Eigen::MatrixXd> scaled(Eigen::MatrixXd::Identity(dim, dim) +
                                             root.asDiagonal() * symmetricPart(s) *
                                                 root.asDiagonal());
    if (scaled.info() != Eigen::Success) return false;
    const double half_log_det = scaled.matrixLLT().diagonal().array().log().sum();
    const Eigen::MatrixXd inverse_width =
        root.asDiagonal() * scaled.solve(Eigen::MatrixXd(root.asDiagonal()));
    const Eigen::VectorXd distance = (z * inverse_width).cwiseProduct(z).rowwise().sum();
    const Eigen::VectorXd q =
        (log_signal_variance_[a] - half_log_det - 0.5 * distance.array()).exp();
    const Eigen::VectorXd terms = q.cwiseProduct(model_.beta.col(a));
    output->mean[a] = terms.sum();
    output->gain.col(a).noalias() = inverse_width * (z.transpose() * terms);
    if (tape != nullptr) {
      tape->inverse_widths.push_back(inverse_width);
      tape->kernel_means.col(a) = q;
    }
  }
  if (tape != nullptr) tape->mean = output->mean;
  return true;
}

/// Computes S_ab. With u_i = Lambda_a^-1 z_i and v_j = Lambda_b^-1 z_j, so that w_ij = u_i + v_j:
///
///   log Q_ij = f_i + g_j + u_i^T T v_j
///   f_i = log sf_a^2 - log|R| / 2 - (z_i^T u_i - u_i^T T u_i) / 2
///
/// and for the sum over P_ij = (weight)_ij Q_ij:
///
///   d/dm = R^-T sum P_ij w_ij,  d/ds = (R^-T (sum P_ij w_ij w_ij^T) R^-1 - P R^-1 sum P_ij) / 2
///
/// Returns false if R has eigenvalues that are not positive.
bool GpMoments::predictPair(int a, int b, const Eigen::MatrixXd& z, const Eigen::MatrixXd& s,
                            Moments* output, Tape* tape) const {
  const Eigen::VectorXd precision_sum = precisions_.col(a) + precisions_.col(b);
  const Pair pair = pairTerms(precision_sum, s);
  if (pair.inner.size() == 0) return false;

  const auto quadratic = [&](const Eigen::Ref<const Eigen::MatrixXd>& scaled) -> Eigen::VectorXd {
    return (scaled * pair.inner - z).cwiseProduct(scaled).rowwise().sum();
  };
  ExponentialMatrix matrix;
  matrix.u = z * precisions_.col(a).asDiagonal();
  const Eigen::MatrixXd scaled_b = z * precisions_.col(b).asDiagonal();
  matrix.v.noalias() = pair.inner * scaled_b.transpose();
  matrix.f = (log_signal_variance_[a] - 0.5 * pair.log_det_R) + 0.5 * quadratic(matrix.u).array();
  matrix.g = log_signal_variance_[b] + 0.5 * quadratic(scaled_b).array();
  matrix.column_weights =
      a == b ? Eigen::VectorXd::Ones(model_.numPoints()) : Eigen::VectorXd(model_.beta.col(b));
  const ExponentialSums sums =
      a == b ? exponentialSums(matrix, weights_[a]) : exponentialSums(matrix, model_.beta.col(a));

  const double factor = a == b ? 2.0 : 1.0;
  const double total = factor * sums.columns.sum();
  double covariance = total;
  if (a == b && !model_.inverse.empty()) covariance += std::exp(log_signal_variance_[a]);
  covariance -= output->mean[a] * output->mean[b];
  output->covariance(a, b) = covariance;
  output->covariance(b, a) = covariance;
  if (tape == nullptr) return true;

  const Eigen::MatrixXd& u = matrix.u;
  const Eigen::VectorXd& rows = sums.rows;
  const Eigen::VectorXd first = u.transpose() * rows + scaled_b.transpose() * sums.columns;
  const Eigen::MatrixXd cross = sums.moments * scaled_b;
  const Eigen::MatrixXd second = u.transpose() * rows.asDiagonal() * u +
                                 scaled_b.transpose() * sums.columns.asDiagonal() * scaled_b +
                                 cross + cross.transpose();
  const Eigen::MatrixXd& K = pair.inverse_R;
  tape->d_sums.push_back({factor * (K.transpose() * first),
                          symmetricPart(0.5 * (factor * (K.transpose() * second * K) -
                                               total * (precision_sum.asDiagonal() * K)))});
  return true;
}

/// With B = (s + Lambda)^-1, p_i = beta_i q_i, mu = dJ/dM, nu = dJ/dV and
/// g_i = p_i (mu + nu^T B z_i):
///
///   dJ/dm = B (sum g_i z_i - M nu)
///   dJ/ds = (B (sum g_i z_i z_i^T) B - B sum g_i - B nu V^T - V nu^T B) / 2
///
/// and by the model, with d Lambda_dd = 2 l_d^2 d log l_d:
///
///   dJ/dX_i = p_i B nu - g_i B z_i,   dJ/dbeta_i = q_i (mu + nu^T B z_i)
///   dJ/dlog l_d = 2 l_d^2 [dJ/ds]_dd + sum g_i
Gaussian GpMoments::backward(const Tape& tape, const Moments& d_output, GpGradient* d_model) const {
  const int dim = model_.inputDim();
  const int outputs = model_.outputDim();
  eigen_assert(d_output.mean.size() == outputs && d_output.gain.rows() == dim);
  eigen_assert(d_model == nullptr || model_.inverse.empty());
  Gaussian d_input = constantGaussian(dim);
  // dJ/dM, including the derivative of the term -M M^T of S
  const Eigen::VectorXd d_mean =
      d_output.mean - (d_output.covariance + d_output.covariance.transpose()) * tape.mean;
  const Eigen::MatrixXd z = (model_.inputs.colwise() - tape.input.mean).transpose();
  for (int a = 0; a < outputs; ++a) {
    const Eigen::MatrixXd& B = tape.inverse_widths[a];
    const Eigen::VectorXd nu = d_output.gain.col(a);
    const Eigen::VectorXd B_nu = B * nu;
    const auto q = tape.kernel_means.col(a);
    const Eigen::VectorXd terms = q.cwiseProduct(model_.beta.col(a));
    const Eigen::VectorXd gain = B * (z.transpose() * terms);
    const Eigen::VectorXd d_terms = d_mean[a] + (z * B_nu).array();
    const Eigen::VectorXd g = terms.cwiseProduct(d_terms);
    const Eigen::MatrixXd second = z.transpose() * g.asDiagonal() * z;
    d_input.mean += B * (z.transpose() * g - tape.mean[a] * nu);
    d_input.covariance +=
        0.5 * (B * second * B - g.sum() * B - B_nu * gain.transpose() - gain * B_nu.transpose());
    if (d_model == nullptr) continue;
    const Eigen::MatrixXd B_z = z * B;  // row i: (B z_i)^T
    d_model->inputs += B_nu * terms.transpose() - B_z.transpose() * g.asDiagonal();
    d_model->beta.col(a) += q.cwiseProduct(d_terms);
    const Eigen::VectorXd model_gain = B_z.transpose() * terms;
    const Eigen::VectorXd d_widths =
        0.5 * (B_z.cwiseProduct(B_z).transpose() * g - g.sum() * B.diagonal()) -
        B_nu.cwiseProduct(model_gain);
    d_model->log_length_scales.col(a).array() +=
        2.0 * d_widths.array() / precisions_.col(a).array() + g.sum();
  }
  std::size_t pair = 0;
  for (int b = 0; b < outputs; ++b) {
    for (int a = 0; a <= b; ++a, ++pair) {
      // dJ/dS_ab + dJ/dS_ba for a < b, and dJ/dS_aa for a = b
      const double d_sum = a == b ? d_output.covariance(a, a)
                                  : d_output.covariance(a, b) + d_output.covariance(b, a);
      d_input.mean += d_sum * tape.d_sums[pair].mean;
      d_input.covariance += d_sum * tape.d_sums[pair].covariance;
      if (d_model != nullptr) pairToModel(a, b, d_sum, z, tape.input.covariance, d_model);
    }
  }
  d_input.covariance = symmetricPart(d_input.covariance);
  return d_input;
}

/// Derivatives of the double sum of S_ab, with u_i, v_j as in predictPair(), y_ij = T (u_i + v_j) -
/// z_i:
///
///   dJ/dX_i = dJ/dS_ab Lambda_a^-1 sum_j P_ij y_ij,   dJ/dbeta_a = dJ/dS_ab Q beta_b
///   dJ/dlog l_ad = dJ/dS_ab l_ad^-2 sum_ij P_ij (T_dd + y_ijd^2)
///
/// and the same for b with i and j exchanged; for a = b the two parts are added.
void GpMoments::pairToModel(int a, int b, double d_sum, const Eigen::MatrixXd& z,
                            const Eigen::MatrixXd& s, GpGradient* d_model) const {
  const Pair pair = pairTerms(precisions_.col(a) + precisions_.col(b), s);
  const Eigen::MatrixXd& T = pair.inner;
  const Eigen::MatrixXd u = z * precisions_.col(a).asDiagonal();
  const Eigen::MatrixXd v = z * precisions_.col(b).asDiagonal();
  const Eigen::MatrixXd T_u = u * T;  // row i: (T u_i)^T
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

}  // namespace ddm::pilco
