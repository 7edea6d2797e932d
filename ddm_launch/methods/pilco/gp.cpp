// Full Gaussian processes: hyper-parameters that maximise the marginal likelihood.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/gp.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "pilco/moments.h"

namespace ddm::pilco {
namespace {

/// Largest squared distance [length-scales^2] at which the covariance is computed. There it is 1e-100
/// of the signal's variance; at larger distances it is set to zero. Products of such small numbers
/// would be denormal, which processors compute a hundred times slower.
constexpr double kFarthest = 460.0;

/// Checks that all numbers are finite and that each row varies.
/// @param samples  one sample per column, at least two columns
/// @throws std::invalid_argument naming the first row that contains no information
void requireVaried(const Eigen::MatrixXd& samples, const char* name) {
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    for (Eigen::Index d = 0; d < samples.rows(); ++d) {
      require(std::isfinite(samples(d, i)), name, " ", d + 1, " of point ", i + 1, " of ",
              samples.cols(), " must be a finite number, got ", samples(d, i));
    }
  }
  const Eigen::VectorXd spread = sampleStd(samples);
  for (Eigen::Index d = 0; d < samples.rows(); ++d) {
    require(std::isfinite(spread[d]), name, " ", d + 1,
            " is too large: its variance is beyond double precision");
    // The extremes are compared too, because the spread of equal numbers may be a rounding error.
    require(spread[d] > 0.0 && samples.row(d).minCoeff() < samples.row(d).maxCoeff(), name, " ",
            d + 1, " is ", samples(d, 0), " in all ", samples.cols(),
            " points: nothing can be learnt from it. Leave it out, or record data in which it "
            "changes; a feature of images: learn fewer of them");
  }
}

/// A = K + sn^2 I and its Cholesky factor, for one output.
struct Covariance {
  Covariance(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& theta)
      : k(squaredExponential(inputs, inputs, theta.head(inputs.rows()).array().exp().matrix(),
                             std::exp(theta[inputs.rows()]))),
        noise_variance(std::exp(2.0 * theta[inputs.rows() + 1])) {
    Eigen::MatrixXd a = k;
    a.diagonal().array() += noise_variance;
    factor.compute(a);
  }
  bool positiveDefinite() const {
    return factor.info() == Eigen::Success && factor.matrixLLT().diagonal().allFinite();
  }
  /// A^-1 = L^-T L^-1, exactly symmetric.
  Eigen::MatrixXd inverse() const {
    const Eigen::Index n = k.rows();
    const Eigen::MatrixXd inverse_factor = factor.matrixL().solve(Eigen::MatrixXd::Identity(n, n));
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
    out.selfadjointView<Eigen::Lower>().rankUpdate(inverse_factor.transpose());
    out.triangularView<Eigen::StrictlyUpper>() = out.transpose();
    return out;
  }

  Eigen::MatrixXd k;  ///< K, without noise                                             [n x n]
  double noise_variance;
  Eigen::LLT<Eigen::MatrixXd> factor;
};

/// 1/2 tr(W dA / d theta_j) for each j, with W = A^-1 - alpha alpha^T.
Eigen::VectorXd likelihoodGradient(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& theta,
                                   const Covariance& covariance, const Eigen::VectorXd& alpha) {
  const Eigen::Index dim = inputs.rows();
  const Eigen::Index n = inputs.cols();
  Eigen::MatrixXd w = covariance.inverse();
  w.noalias() -= alpha * alpha.transpose();
  const double trace = w.trace();
  w.array() *= covariance.k.array();  // dK / d log sf = 2 K

  const Eigen::VectorXd length_scales = theta.head(dim).array().exp();
  const Eigen::MatrixXd scaled = (length_scales.cwiseInverse().asDiagonal() * inputs).transpose();
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(dim + 2);
  for (Eigen::Index j = 0; j < n; ++j) {  // dK_ij / d log l_d = K_ij ((x_di - x_dj) / l_d)^2
    for (Eigen::Index d = 0; d < dim; ++d) {
      const auto difference = scaled.col(d).array() - scaled(j, d);
      gradient[d] += 0.5 * (w.col(j).array() * difference.square()).sum();
    }
  }
  gradient[dim] = w.sum();
  gradient[dim + 1] = covariance.noise_variance * trace;
  return gradient;
}

}  // namespace

Eigen::MatrixXd squaredExponential(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                   const Eigen::VectorXd& length_scales, double signal_std) {
  eigen_assert(a.rows() == length_scales.size() && b.rows() == length_scales.size());
  // The coordinates of `a` are contiguous columns, so that each column of k is one vectorised loop.
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

double negativeLogLikelihood(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& targets,
                             const Eigen::VectorXd& theta, Eigen::VectorXd* gradient) {
  eigen_assert(theta.size() == inputs.rows() + 2 && targets.size() == inputs.cols());
  if (gradient != nullptr) gradient->setConstant(theta.size(), kNaN);
  if (!theta.allFinite()) return kInfinity;
  const Covariance covariance(inputs, theta);
  if (!covariance.positiveDefinite()) return kInfinity;
  const Eigen::VectorXd alpha = covariance.factor.solve(targets);
  const double half_log_determinant = covariance.factor.matrixLLT().diagonal().array().log().sum();
  if (gradient != nullptr) *gradient = likelihoodGradient(inputs, theta, covariance, alpha);
  const double value = 0.5 * targets.dot(alpha) + half_log_determinant +
                       0.5 * static_cast<double>(inputs.cols()) * kLogTwoPi;
  return std::isfinite(value) ? value : kInfinity;
}

double penalty(const Eigen::VectorXd& theta, const Eigen::VectorXd& input_std,
               Eigen::VectorXd* gradient) {
  const Eigen::Index dim = input_std.size();
  eigen_assert(theta.size() == dim + 2);
  const double p = kPenaltyPower;
  const double log_length_limit = std::log(kLengthScaleLimit);
  const double log_snr_limit = std::log(kSignalToNoiseLimit);
  const Eigen::ArrayXd length =
      (theta.head(dim).array() - input_std.array().log()) / log_length_limit;
  const double snr = (theta[dim] - theta[dim + 1]) / log_snr_limit;
  if (gradient != nullptr) {
    gradient->head(dim).array() += p / log_length_limit * length.pow(kPenaltyPower - 1);
    const double slope = p / log_snr_limit * std::pow(snr, kPenaltyPower - 1);
    (*gradient)[dim] += slope;
    (*gradient)[dim + 1] -= slope;
  }
  return length.pow(kPenaltyPower).sum() + std::pow(snr, kPenaltyPower);
}

Eigen::VectorXd sampleStd(const Eigen::MatrixXd& samples) {
  eigen_assert(samples.cols() >= 2);
  const Eigen::MatrixXd centred = samples.colwise() - samples.rowwise().mean();
  return (centred.rowwise().squaredNorm() / static_cast<double>(samples.cols() - 1)).cwiseSqrt();
}

Hyperparameters initialHyperparameters(const Eigen::MatrixXd& inputs,
                                       const Eigen::MatrixXd& targets) {
  eigen_assert(inputs.cols() == targets.rows());
  require(inputs.cols() >= 2, "training a GP needs at least 2 points, got ", inputs.cols());
  requireVaried(inputs, "input");
  requireVaried(targets.transpose(), "target");
  const Eigen::VectorXd log_spread = sampleStd(inputs).array().log();
  const Eigen::VectorXd log_signal = sampleStd(targets.transpose()).array().log();
  Hyperparameters out(inputs.rows() + 2, targets.cols());
  out << log_spread.replicate(1, targets.cols()), log_signal.transpose(),
      (log_signal.array() - std::log(10.0)).matrix().transpose();
  return out;
}

GpFit makeGpModel(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                  const Hyperparameters& hyperparameters) {
  eigen_assert(inputs.cols() == targets.rows());
  GpFit fit;
  GpModel model{inputs, hyperparameters, Eigen::MatrixXd(targets.rows(), targets.cols()), {}};
  for (int a = 0; a < targets.cols(); ++a) {
    const Covariance covariance(inputs, hyperparameters.col(a));
    if (!covariance.positiveDefinite()) {
      fit.message = textOf("the covariance of output ", a + 1,
                           " is not positive definite: its noise std must be larger");
      return fit;
    }
    model.beta.col(a) = covariance.factor.solve(targets.col(a));
    model.inverse.push_back(covariance.inverse());
  }
  fit.model = std::move(model);
  return fit;
}

void GpFit::addMessage(const std::string& text) {
  if (!text.empty()) message += (message.empty() ? "" : "; ") + text;
}

void GpFit::add(GpFit later) {
  model = std::move(later.model);
  outputs.insert(outputs.end(), later.outputs.begin(), later.outputs.end());
  addMessage(later.message);
}

GpFit trainGp(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, int max_iterations,
              const Hyperparameters& start, const std::function<void()>& on_evaluation) {
  const Hyperparameters initial = initialHyperparameters(inputs, targets);
  const Eigen::VectorXd input_std = sampleStd(inputs);

  MinimiseOptions solver;
  solver.max_iterations = max_iterations;
  solver.max_evaluations = kEvaluationsPerIteration * max_iterations;
  solver.function_tolerance = 1e-13;
  solver.gradient_tolerance = 1e-6;
  Hyperparameters trained = initial;
  GpFit training;
  for (int a = 0; a < targets.cols(); ++a) {
    const auto say = [&training, a](const std::string& text) {
      training.addMessage(textOf("output ", a + 1, ": ", text));
    };
    const Eigen::VectorXd y = targets.col(a);
    const auto trainFrom = [&](const Hyperparameters& from) {
      const auto objective = [&](const Eigen::VectorXd& theta, Eigen::VectorXd* gradient) {
        const double plain = negativeLogLikelihood(inputs, y, theta, gradient);
        if (on_evaluation) on_evaluation();
        return plain + penalty(theta, input_std, gradient);
      };
      return minimise(objective, from.col(a), solver);
    };
    SolverResult result = trainFrom(start.size() > 0 ? start : initial);
    if (result.reason == TerminationReason::kStartFailed && start.size() > 0) {
      say("the previous hyper-parameters cannot be evaluated, trained anew");
      result = trainFrom(initial);
    }
    if (result.reason == TerminationReason::kStartFailed) {
      say("the likelihood cannot be evaluated at the start of the training");
      return training;
    }
    training.outputs.push_back(result);
    if (!result.improved() && !result.converged()) say("kept at the start, " + result.message);
    trained.col(a) = result.x;
  }
  training.add(makeGpModel(inputs, targets, trained));
  return training;
}

}  // namespace ddm::pilco
