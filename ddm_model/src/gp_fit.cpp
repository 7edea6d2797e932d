// Fits the Gaussian process of model/predictor gp to features and torques.
// SPDX-License-Identifier: BSD-3-Clause
#include "gp_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ddm {
namespace {

constexpr Eigen::Index kMaxLikelihoodSamples = 400;  // the time grows with the cube
constexpr Eigen::Index kCentresForOutliers = 300;    // enough to find outliers
constexpr double kUnexplained = 0.03;  // variance without the centres / variance of the noise
constexpr double kRounding = 1e-12;    // relative error of a variance in decompose()
constexpr int kMaxIterations = 40;
constexpr double kInitialNoise = 0.3;  // sigma, if the outputs have standard deviation 1
constexpr double kJitter = 1e-8;       // added to the variance of the noise
constexpr double kRidge = 1e-3;        // of the linear mean, per sample
constexpr int kOutlierRounds = 2;
constexpr double kOutlier = 12.0;               // squared error of an outlier / median
constexpr double kSmallestError = 0.03 * 0.03;  // smaller squared errors count as this

// Weights of the prior: each hyper-parameter p adds w (p - p_0)^2, which is small next to the
// likelihood of a hundred samples.
constexpr double kScalePrior = 0.02;  // of log l; p_0: log sqrt(D)
constexpr double kSizePrior = 0.1;    // of log s and of log sigma; p_0: 0 and log 0.3

Eigen::MatrixXd columnsOf(const Eigen::MatrixXd& matrix, const std::vector<Eigen::Index>& columns) {
  Eigen::MatrixXd out(matrix.rows(), static_cast<Eigen::Index>(columns.size()));
  for (size_t i = 0; i < columns.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) = matrix.col(columns[i]);
  return out;
}

/// @return standard deviations of the rows, or 1 where all values are equal
Eigen::VectorXd spreadOf(const Eigen::MatrixXd& values) {
  const Eigen::MatrixXd centred = values.colwise() - values.rowwise().mean();
  const Eigen::VectorXd spread =
      centred.rowwise().norm() / std::sqrt(static_cast<double>(values.cols()));
  return (spread.array() > 0.0).select(spread, 1.0);
}

/// @return indices 0 ... count - 1 in a random order
std::vector<Eigen::Index> shuffled(Eigen::Index count, std::mt19937_64* rng) {
  std::vector<Eigen::Index> order(count);
  std::iota(order.begin(), order.end(), Eigen::Index(0));
  for (Eigen::Index i = count - 1; i > 0; --i) {
    std::swap(order[i], order[std::uniform_int_distribution<Eigen::Index>(0, i)(*rng)]);
  }
  return order;
}

/// @return s^2 exp(-|a_i - a_j|^2 / 2) for all columns a of A  [N x N]
Eigen::MatrixXd kernelMatrix(const Eigen::MatrixXd& A, double variance) {
  const Eigen::VectorXd norms = 0.5 * A.colwise().squaredNorm();
  Eigen::MatrixXd K = A.transpose() * A;
  K.colwise() -= norms;
  K.rowwise() -= norms.transpose();
  return variance * K.array().min(0.0).exp();
}

/// Rank-M approximation L L' of a kernel matrix.
struct PivotedCholesky {
  Eigen::MatrixXd L;                 // [N x M]
  std::vector<Eigen::Index> pivots;  // centres, in the order in which they were selected  [M]
};

/// @param A          inputs / l          [D x N]
/// @param variance   s^2
/// @param tolerance  largest variance that is not explained
/// @param max_rank   cap on M, at most N
PivotedCholesky decompose(const Eigen::MatrixXd& A, double variance, double tolerance,
                          Eigen::Index max_rank) {
  PivotedCholesky out;
  out.L.resize(A.cols(), max_rank);
  Eigen::VectorXd rest = Eigen::VectorXd::Constant(A.cols(), variance);
  for (Eigen::Index rank = 0; rank < max_rank; ++rank) {
    Eigen::Index pivot;
    if (rest.maxCoeff(&pivot) <= tolerance) break;
    const Eigen::VectorXd distances = (A.colwise() - A.col(pivot)).colwise().squaredNorm();
    Eigen::VectorXd column = variance * (-0.5 * distances).array().exp();
    column.noalias() -= out.L.leftCols(rank) * out.L.row(pivot).head(rank).transpose();
    out.L.col(rank) = column / std::sqrt(rest[pivot]);
    rest = (rest - out.L.col(rank).cwiseAbs2()).cwiseMax(0.0);
    rest[pivot] = 0.0;
    out.pivots.push_back(pivot);
  }
  out.L.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(out.pivots.size()));
  return out;
}

/// A Gaussian process of which the hyper-parameters are known.
struct DenseGp {
  Eigen::VectorXd input_mean, input_spread, output_mean, output_spread;
  Eigen::MatrixXd slope;    // of the linear mean function, for inputs of standard deviation 1
  Eigen::MatrixXd outputs;  // what the linear mean does not explain, of standard deviation 1
  Eigen::VectorXd p;        // hyper-parameters, see negativeLogLikelihood()
};

/// Fits the linear mean by ridge regression, which leaves the mean of the outputs alone, and the
/// hyper-parameters by minimise().
DenseGp fitDense(const Eigen::MatrixXd& regressors, const Eigen::MatrixXd& changes,
                 std::mt19937_64* rng, const std::function<void()>& check) {
  const Eigen::Index D = regressors.rows(), N = regressors.cols();
  DenseGp gp;
  gp.input_mean = regressors.rowwise().mean();
  gp.input_spread = spreadOf(regressors);
  gp.output_mean = changes.rowwise().mean();
  const Eigen::MatrixXd inputs =
      gp.input_spread.cwiseInverse().asDiagonal() * (regressors.colwise() - gp.input_mean);
  gp.outputs = changes.colwise() - gp.output_mean;
  Eigen::MatrixXd gram = inputs * inputs.transpose();
  gram.diagonal().array() += kRidge * static_cast<double>(N);
  gp.slope = gram.llt().solve(inputs * gp.outputs.transpose()).transpose();
  gp.outputs -= gp.slope * inputs;
  gp.output_spread = spreadOf(gp.outputs);
  gp.outputs = gp.output_spread.cwiseInverse().asDiagonal() * gp.outputs;

  std::vector<Eigen::Index> drawn = shuffled(N, rng);
  drawn.resize(std::min(N, kMaxLikelihoodSamples));
  Eigen::VectorXd start(D + 2);
  start.head(D).setConstant(0.5 * std::log(static_cast<double>(D)));
  start.tail(2) << 0.0, std::log(kInitialNoise);
  MinimiseOptions options;
  options.max_iterations = kMaxIterations;
  options.function_tolerance = 1e-5;
  options.on_iteration = [&check](const SolverResult&) {
    check();
    return true;
  };
  gp.p = minimise(negativeLogLikelihood(columnsOf(inputs, drawn), columnsOf(gp.outputs, drawn)),
                  start, options)
             .x;
  return gp;
}

}  // namespace

Transitions transitionsOf(const PredictionModel<double>& f, const Eigen::MatrixXd& Z,
                          const DataSet& data) {
  const Eigen::Index n = f.order(), dim = f.featureDim(), motors = f.torqueDim();
  Eigen::Index count = 0;
  for (const Segment& segment : data.segments())
    count += std::max<Eigen::Index>(segment.size - n, 0);
  Transitions out{Eigen::MatrixXd(f.regressorDim(), count), Eigen::MatrixXd(dim, count)};
  Eigen::Index i = 0;
  for (const Segment& segment : data.segments()) {
    for (Eigen::Index t = segment.begin + n - 1; t + 1 < segment.begin + segment.size; ++t, ++i) {
      Eigen::Index row = 0;
      for (Eigen::Index lag = 0; lag < n; ++lag) {  // eq. (2)
        if (lag < f.numFeatures()) {
          out.regressors.col(i).segment(row, dim) = Z.col(t - lag);
          row += dim;
        }
        out.regressors.col(i).segment(row, motors) =
            data.torques().col(t - lag).cwiseQuotient(f.maxTorque());
        row += motors;
      }
      out.changes.col(i) = Z.col(t + 1) - Z.col(t);
    }
  }
  f.toDifferences(out.regressors);
  return out;
}

DifferentiableFunction negativeLogLikelihood(const Eigen::MatrixXd& inputs,
                                             const Eigen::MatrixXd& outputs) {
  return [inputs, outputs](const Eigen::VectorXd& p, Eigen::VectorXd* gradient) {
    const Eigen::Index D = inputs.rows(), N = inputs.cols();
    const auto E = static_cast<double>(outputs.rows());
    const Eigen::MatrixXd A = (-p.head(D)).array().exp().matrix().asDiagonal() * inputs;
    const double noise = std::exp(2.0 * p[D + 1]);
    const Eigen::MatrixXd K = kernelMatrix(A, std::exp(2.0 * p[D]));
    Eigen::MatrixXd noisy = K;
    noisy.diagonal().array() += noise + kJitter;
    const Eigen::LLT<Eigen::MatrixXd> llt(noisy);
    if (llt.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
    const Eigen::MatrixXd alpha = llt.solve(outputs.transpose());
    const Eigen::VectorXd d_scales = p.head(D).array() - 0.5 * std::log(static_cast<double>(D));
    const double d_size = p[D], d_noise = p[D + 1] - std::log(kInitialNoise);
    if (gradient != nullptr) {
      Eigen::MatrixXd d_K = llt.solve(0.5 * E * Eigen::MatrixXd::Identity(N, N));
      d_K.noalias() -= 0.5 * alpha * alpha.transpose();
      const double d_noise_variance = d_K.trace();
      d_K = d_K.cwiseProduct(K);
      const Eigen::VectorXd sums = d_K.rowwise().sum();
      gradient->resize(D + 2);
      gradient->head(D) = 2.0 * (A.cwiseAbs2() * sums - A.cwiseProduct(A * d_K).rowwise().sum()) +
                          2.0 * kScalePrior * d_scales;
      (*gradient)[D] = 2.0 * sums.sum() + 2.0 * kSizePrior * d_size;
      (*gradient)[D + 1] = 2.0 * noise * d_noise_variance + 2.0 * kSizePrior * d_noise;
    }
    return 0.5 * outputs.transpose().cwiseProduct(alpha).sum() +
           E * llt.matrixLLT().diagonal().array().log().sum() +
           kScalePrior * d_scales.squaredNorm() +
           kSizePrior * (d_size * d_size + d_noise * d_noise);
  };
}

Eigen::VectorXd fitGp(const Transitions& transitions, std::mt19937_64* rng,
                      const std::function<void()>& check, Eigen::Index max_centres) {
  if (transitions.regressors.cols() == 0) {
    throw std::invalid_argument(
        "model/predictor gp needs segments with more than model/order samples: record longer "
        "episodes, or reduce model/order");
  }
  const DenseGp gp = fitDense(transitions.regressors, transitions.changes, rng, check);
  const Eigen::Index D = transitions.regressors.rows();
  const double variance = std::exp(2.0 * gp.p[D]), noise = std::exp(2.0 * gp.p[D + 1]) + kJitter;
  const Eigen::VectorXd inverse_scales =
      (-gp.p.head(D)).array().exp() / gp.input_spread.array();  // of regressors as they are
  const Eigen::MatrixXd A = inverse_scales.asDiagonal() * transitions.regressors;
  const double tolerance = std::max(kUnexplained * noise, kRounding * variance);
  const PivotedCholesky cholesky =
      decompose(A, variance, tolerance, std::min(A.cols(), max_centres));
  const Eigen::MatrixXd& L = cholesky.L;
  Eigen::MatrixXd normal = L.transpose() * L;
  normal.diagonal().array() += noise;
  Eigen::MatrixXd weights = normal.llt().solve(L.transpose() * gp.outputs.transpose());
  const Eigen::MatrixXd pivot_rows = columnsOf(L.transpose(), cholesky.pivots);  // upper triangle
  pivot_rows.triangularView<Eigen::Upper>().solveInPlace(weights);

  const Eigen::MatrixXd slope = gp.slope * gp.input_spread.cwiseInverse().asDiagonal();
  const Eigen::VectorXd bias = gp.output_mean - slope * gp.input_mean;
  const Eigen::MatrixXd centres = columnsOf(A, cholesky.pivots);
  const Eigen::MatrixXd scaled_weights =
      variance * gp.output_spread.asDiagonal() * weights.transpose();
  const auto flat = [](const Eigen::MatrixXd& matrix) {
    return Eigen::Map<const Eigen::VectorXd>(matrix.data(), matrix.size());
  };
  Eigen::VectorXd theta(D + slope.size() + bias.size() + centres.size() + scaled_weights.size());
  theta << inverse_scales, flat(slope), bias, flat(centres), flat(scaled_weights);
  return theta;
}

Transitions withoutOutliers(const Transitions& transitions, std::mt19937_64* rng,
                            const std::function<void()>& check) {
  const auto D = static_cast<int>(transitions.regressors.rows());
  const auto E = static_cast<int>(transitions.changes.rows());
  const Eigen::MatrixXd units = spreadOf(transitions.changes).cwiseInverse().asDiagonal();
  Transitions kept = transitions;
  for (int round = 0; round < kOutlierRounds; ++round) {
    const Eigen::VectorXd theta = fitGp(kept, rng, check, kCentresForOutliers);
    const GpMean<double> f = GpMean<double>::ofSize(D, E, theta.size());
    GpMean<double>::Tape tape;
    f.forward(theta.data(), transitions.regressors, &tape);
    const Eigen::VectorXd errors =
        (units * (transitions.changes - tape.output())).colwise().squaredNorm() / E;
    Eigen::VectorXd sorted = errors;
    double* median = sorted.data() + sorted.size() / 2;
    std::nth_element(sorted.data(), median, sorted.data() + sorted.size());
    const double limit = kOutlier * std::max(*median, kSmallestError);
    std::vector<Eigen::Index> indices;
    for (Eigen::Index i = 0; i < errors.size(); ++i) {
      if (errors[i] <= limit) indices.push_back(i);
    }
    kept = {columnsOf(transitions.regressors, indices), columnsOf(transitions.changes, indices)};
  }
  return kept;
}

Eigen::VectorXd replaceByGp(const ModelOptions& model, const Eigen::VectorXd& theta,
                            const Eigen::MatrixXd& Z, const DataSet& data, std::mt19937_64* rng,
                            const std::function<void()>& check) {
  const PredictionModel<double> f(model, data.torqueDim());
  const Transitions transitions = withoutOutliers(transitionsOf(f, Z, data), rng, check);
  const Eigen::VectorXd theta_p = fitGp(transitions, rng, check);
  Eigen::VectorXd out(theta.size() + theta_p.size());
  out << theta, theta_p;
  return out;
}

}  // namespace ddm
