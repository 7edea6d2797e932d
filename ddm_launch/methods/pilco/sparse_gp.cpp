// Sparse GP (FITC), which has a few inducing inputs instead of all training inputs.
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "pilco/gp.h"
#include "pilco/moments.h"

namespace ddm::pilco {
namespace {

/// Matrices of one output. B = L M L^T with Kmm = L L^T, M = I + V diag(lambda)^-1 V^T and
/// V = L^-1 Kmn. M is much better conditioned than B.
struct Fitc {
  Fitc(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
       const Eigen::VectorXd& theta) {
    const Eigen::Index dim = inputs.rows();
    const Eigen::VectorXd length_scales = theta.head(dim).array().exp();
    const double sf = std::exp(theta[dim]);
    k_mm = squaredExponential(inducing, inducing, length_scales, sf);
    k_mn = squaredExponential(inducing, inputs, length_scales, sf);
    Eigen::MatrixXd ridged = k_mm;
    ridged.diagonal().array() += kRidge;
    l.compute(ridged);
    if (l.info() != Eigen::Success) return;
    v = l.matrixL().solve(k_mn);
    lambda = std::exp(2.0 * theta[dim + 1]) + sf * sf - v.colwise().squaredNorm().array();
    if (!(lambda > 0.0).all()) return;
    v_scaled = v * lambda.inverse().matrix().asDiagonal();
    Eigen::MatrixXd m_matrix = v_scaled * v.transpose();
    m_matrix.diagonal().array() += 1.0;
    m.compute(m_matrix);
    positive_definite = m.info() == Eigen::Success && m.matrixLLT().diagonal().allFinite() &&
                        lambda.isFinite().all();
  }

  /// L^-T x
  Eigen::MatrixXd backsolve(const Eigen::MatrixXd& x) const { return l.matrixU().solve(x); }
  /// B^-1 Kmn diag(lambda)^-1 y
  Eigen::VectorXd beta(const Eigen::VectorXd& y) const { return backsolve(m.solve(v_scaled * y)); }

  Eigen::MatrixXd k_mm;           ///< Kmm without ridge                                 [m x m]
  Eigen::MatrixXd k_mn;           ///<                                                   [m x n]
  Eigen::LLT<Eigen::MatrixXd> l;  ///< Cholesky factor of Kmm with ridge
  Eigen::MatrixXd v;              ///<                                                   [m x n]
  Eigen::ArrayXd lambda;          ///<                                                       [n]
  Eigen::MatrixXd v_scaled;       ///< V diag(lambda)^-1                                 [m x n]
  Eigen::LLT<Eigen::MatrixXd> m;
  bool positive_definite = false;
};

/// Adds the gradient of one output's likelihood with respect to Z. With T = Kmm^-1 Kmn, R = B^-1
/// Kmn diag(lambda)^-1, alpha = C^-1 y and w_i = [C^-1]_ii - alpha_i^2:
///
///   dL/dKmn = R - beta alpha^T - T diag(w),   dL/dKmm = -1/2 (dL/dKmn) T^T
void addGradient(const Fitc& fitc, const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                 const Eigen::VectorXd& theta, const Eigen::VectorXd& beta,
                 const Eigen::VectorXd& alpha, Eigen::MatrixXd* d_inducing) {
  const Eigen::MatrixXd t = fitc.backsolve(fitc.v);
  const Eigen::MatrixXd r = fitc.backsolve(fitc.m.solve(fitc.v_scaled));
  const Eigen::ArrayXd inverse_diagonal =
      (1.0 - fitc.k_mn.cwiseProduct(r).colwise().sum().transpose().array()) / fitc.lambda;
  const Eigen::ArrayXd w = inverse_diagonal - alpha.array().square();
  Eigen::MatrixXd d_mn = r - beta * alpha.transpose() - t * w.matrix().asDiagonal();
  Eigen::MatrixXd d_mm = -0.5 * d_mn * t.transpose();
  d_mm += d_mm.transpose().eval();  // z_k affects both row k and column k
  d_mn.array() *= fitc.k_mn.array();
  d_mm.array() *= fitc.k_mm.array();

  // dk(z, x) / dz = -k(z, x) (z - x) / l^2
  const Eigen::VectorXd row_sums = d_mn.rowwise().sum() + d_mm.rowwise().sum();
  const Eigen::MatrixXd pull = inputs * d_mn.transpose() + inducing * d_mm.transpose();
  const Eigen::VectorXd weights = (-2.0 * theta.head(inputs.rows()).array()).exp();
  *d_inducing += weights.asDiagonal() * (pull - inducing * row_sums.asDiagonal());
}

double outputLikelihood(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                        const Eigen::VectorXd& y, const Eigen::VectorXd& theta,
                        Eigen::MatrixXd* d_inducing) {
  const Fitc fitc(inducing, inputs, theta);
  if (!fitc.positive_definite) return kInfinity;
  const Eigen::VectorXd beta = fitc.beta(y);
  const Eigen::VectorXd alpha = ((y - fitc.k_mn.transpose() * beta).array() / fitc.lambda).matrix();
  if (d_inducing != nullptr) addGradient(fitc, inducing, inputs, theta, beta, alpha, d_inducing);
  return 0.5 * y.dot(alpha) + fitc.m.matrixLLT().diagonal().array().log().sum() +
         0.5 * fitc.lambda.log().sum() + 0.5 * static_cast<double>(y.size()) * kLogTwoPi;
}

/// Draws `count` different numbers out of 0 ... n - 1, in random order.
std::vector<Eigen::Index> randomIndices(Eigen::Index n, int count, std::mt19937_64* rng) {
  eigen_assert(count >= 1 && count <= n);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), *rng);  // other standard libraries draw other numbers
  order.resize(static_cast<std::size_t>(count));
  return order;
}

Eigen::MatrixXd columnsOf(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& indices) {
  Eigen::MatrixXd out(matrix.rows(), indices.size());
  Eigen::Index next = 0;
  for (const Eigen::Index i : indices) out.col(next++) = matrix.col(i);
  return out;
}

}  // namespace

double sparseNegativeLogLikelihood(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                                   const Eigen::MatrixXd& targets,
                                   const Hyperparameters& hyperparameters,
                                   Eigen::MatrixXd* d_inducing) {
  eigen_assert(inducing.rows() == inputs.rows() && inputs.cols() == targets.rows());
  if (d_inducing != nullptr) d_inducing->setZero(inducing.rows(), inducing.cols());
  double sum = 0.0;
  for (int a = 0; a < targets.cols(); ++a) {
    sum += outputLikelihood(inducing, inputs, targets.col(a), hyperparameters.col(a), d_inducing);
  }
  if (std::isfinite(sum)) return sum;
  if (d_inducing != nullptr) d_inducing->setConstant(kNaN);
  return kInfinity;
}

GpFit makeSparseGpModel(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                        const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters) {
  eigen_assert(inducing.rows() == inputs.rows() && inputs.cols() == targets.rows());
  const Eigen::Index m = inducing.cols();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(m, m);
  GpFit fit;
  GpModel model{inducing, hyperparameters, Eigen::MatrixXd(m, targets.cols()), {}};
  for (int a = 0; a < targets.cols(); ++a) {
    const Fitc fitc(inducing, inputs, hyperparameters.col(a));
    if (!fitc.positive_definite) {
      fit.message = textOf("the sparse covariance of output ", a + 1,
                           " is not positive definite: its noise std must be larger");
      return fit;
    }
    model.beta.col(a) = fitc.beta(targets.col(a));
    // Kmm^-1 - B^-1 = L^-T (I - M^-1) L^-1
    const Eigen::MatrixXd half = fitc.backsolve(identity - fitc.m.solve(identity));
    const Eigen::MatrixXd inverse = fitc.backsolve(half.transpose());
    model.inverse.push_back(0.5 * (inverse + inverse.transpose()));
  }
  fit.model = std::move(model);
  return fit;
}

GpFit trainSparseGp(const Eigen::MatrixXd& start, const Eigen::MatrixXd& inputs,
                    const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters,
                    int max_iterations, const std::function<void()>& on_evaluation) {
  const auto cost = [&](const Eigen::VectorXd& x, Eigen::VectorXd* gradient) {
    const Eigen::MatrixXd inducing =
        Eigen::Map<const Eigen::MatrixXd>(x.data(), start.rows(), start.cols());
    Eigen::MatrixXd d_inducing;
    const double value = sparseNegativeLogLikelihood(inducing, inputs, targets, hyperparameters,
                                                     gradient != nullptr ? &d_inducing : nullptr);
    if (gradient != nullptr) {
      *gradient = Eigen::Map<const Eigen::VectorXd>(d_inducing.data(), d_inducing.size());
    }
    if (on_evaluation) on_evaluation();
    return value;
  };
  MinimiseOptions solver;
  solver.lbfgs_rank = 20;
  solver.max_iterations = max_iterations;
  solver.max_evaluations = kEvaluationsPerIteration * max_iterations;
  solver.function_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-5;
  const SolverResult result =
      minimise(cost, Eigen::Map<const Eigen::VectorXd>(start.data(), start.size()), solver);
  const Eigen::MatrixXd inducing =
      Eigen::Map<const Eigen::MatrixXd>(result.x.data(), start.rows(), start.cols());
  GpFit fit = makeSparseGpModel(inducing, inputs, targets, hyperparameters);
  fit.outputs.push_back(result);
  if (fit.ok() && !result.improved() && !result.converged()) {
    fit.message = "inducing inputs kept at the start, " + result.message;
  }
  return fit;
}

GpFit learnGp(const PilcoOptions& options, const Eigen::MatrixXd& inputs,
              const Eigen::MatrixXd& targets, std::mt19937_64* rng, GpLearnerState* state,
              const std::function<void()>& on_evaluation) {
  eigen_assert(state->hyperparameters.size() == 0 ||
               (state->hyperparameters.rows() == inputs.rows() + 2 &&
                state->hyperparameters.cols() == targets.cols()));
  const bool use_sparse = inputs.cols() > options.max_points;
  const int count = options.hyperparameter_points;
  const bool use_subset = count > 0 && inputs.cols() > count;
  Eigen::MatrixXd X = inputs, Y = targets;  // from which the hyper-parameters are learned
  if (use_subset) {
    const std::vector<Eigen::Index> drawn = randomIndices(inputs.cols(), count, rng);
    X = columnsOf(inputs, drawn);
    Y = columnsOf(targets.transpose(), drawn).transpose();
  }
  GpFit fit =
      trainGp(X, Y, options.hyperparameter_iterations, state->hyperparameters, on_evaluation);
  if (!fit.ok()) return fit;
  state->hyperparameters = fit.model.hyperparameters;
  if (!use_sparse) {
    if (use_subset) fit.add(makeGpModel(inputs, targets, state->hyperparameters));
    return fit;
  }

  const bool first = state->inducing.size() == 0;
  const Eigen::MatrixXd start =
      first ? columnsOf(inputs, randomIndices(inputs.cols(), options.max_points, rng))
            : state->inducing;
  fit.add(trainSparseGp(start, inputs, targets, state->hyperparameters,
                        first ? options.first_inducing_iterations : options.inducing_iterations,
                        on_evaluation));
  if (fit.ok()) state->inducing = fit.model.inputs;
  return fit;
}

}  // namespace ddm::pilco
