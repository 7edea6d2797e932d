// Gaussian processes of the dynamics, full and sparse, and their training.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/minimise.h>

#include <Eigen/Core>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "pilco/options.h"

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

/// The result of a training: GPs, or the reason why there are none.
struct GpFit {
  bool ok = false;               ///< whether `model` can be used
  GpModel model;                 ///< empty if not
  std::vector<Minimum> outputs;  ///< result of each minimisation
  std::string message;           ///< what failed or is noteworthy; empty if all went well

  void addMessage(const std::string& text);
};

/// A line search takes about two evaluations; one that takes many more is lost in rounding errors.
constexpr int kEvaluationsPerIteration = 3;
constexpr double kRidge = 1e-6;  ///< on the diagonal of Kmm, as published [unit of the output^2]
constexpr double kLengthScaleLimit = 100.0;     ///< in units of the input's spread, as published
constexpr double kSignalToNoiseLimit = 1000.0;  ///< signal std / noise std, as published
constexpr int kPenaltyPower = 30;               ///< steepness of the penalty, as published

/// k(a, b) = signal_std^2 exp(-1/2 sum_d ((a_d - b_d) / length_scales_d)^2) of all pairs.
///
/// The differences are formed before they are squared: |a|^2 - 2 a b + |b|^2 would lose half of the
/// digits where points lie close together.
/// @param a  one input per column                                                    [D x n_a]
/// @param b  one input per column                                                    [D x n_b]
/// @return   row i, column j: k(a_i, b_j)                                          [n_a x n_b]
Eigen::MatrixXd squaredExponential(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                   const Eigen::VectorXd& length_scales, double signal_std);

/// Sample standard deviation (divisor n - 1) of each row.
/// @pre at least two columns (checked by eigen_assert)
Eigen::VectorXd sampleStd(const Eigen::MatrixXd& samples);

/// theta of one output: [log l_1 ... log l_D, log sf, log sn].                        [D + 2]
Eigen::VectorXd thetaOf(const Hyperparameters& hyperparameters, int output);

/// Negative log marginal likelihood of one output:
///
///   1/2 y^T A^-1 y + 1/2 log|A| + n/2 log(2 pi),   A = K + sn^2 I
///
/// @param inputs    one per column                                                     [D x n]
/// @param targets   y                                                                      [n]
/// @param theta     see thetaOf()                                                      [D + 2]
/// @param gradient  (optional) out: with respect to theta                              [D + 2]
/// @return          +infinity (gradient NaN) where A is not positive definite in double
///                  precision, or theta is not finite
double negativeLogLikelihood(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& targets,
                             const Eigen::VectorXd& theta, Eigen::VectorXd* gradient = nullptr);

/// A penalty that keeps the training from absurd length-scales and from almost no noise.
///
///   sum_d (log(l_d / std_d) / log kLengthScaleLimit)^p + (log(sf / sn) / log kSignalToNoiseLimit)^p
///
/// with p = kPenaltyPower.
/// @param theta      see thetaOf()                                                     [D + 2]
/// @param input_std  spread of each input                                                  [D]
/// @param gradient   (optional) the gradient is ADDED to it                            [D + 2]
double penalty(const Eigen::VectorXd& theta, const Eigen::VectorXd& input_std,
               Eigen::VectorXd* gradient = nullptr);

/// Initial hyper-parameters of the first training: length-scales = spread of the inputs, signal =
/// spread of the target, noise = a tenth of the signal.
/// @param inputs   one per column                                                      [D x n]
/// @param targets  one per row                                                         [n x E]
/// @throws std::invalid_argument that names what makes the data unusable: fewer than two points, a
///         number that is not finite, an input or a target that is the same in all points
Hyperparameters initialHyperparameters(const Eigen::MatrixXd& inputs,
                                       const Eigen::MatrixXd& targets);

/// The GP of these hyper-parameters: beta = A^-1 y and A^-1 for each output.
/// @return not ok, with the output's number, where A is not positive definite in double precision
GpFit makeGpModel(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                  const Hyperparameters& hyperparameters);

/// Trains each output by itself by BFGS on negativeLogLikelihood() + penalty(), without restarts.
///
/// Data with repeated points are fine: the penalty keeps the noise large enough. Where the start
/// cannot be evaluated (a covariance that is not positive definite), initialHyperparameters() is
/// tried instead, and the message says so.
/// @param max_iterations  for each output
/// @param start           (optional) previous optimum; null: initialHyperparameters()
/// @param on_evaluation   (optional) called after each evaluation of an objective
/// @throws std::invalid_argument as initialHyperparameters()
GpFit trainGp(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, int max_iterations,
              const Hyperparameters* start = nullptr,
              const std::function<void()>& on_evaluation = nullptr);

/// Negative log marginal likelihood of all outputs together under FITC:
///
///   sum_a  1/2 y_a^T C_a^-1 y_a + 1/2 log|C_a| + n/2 log(2 pi)
///   C = Knm Kmm^-1 Kmn + diag(lambda),   Kmm = k(Z, Z) + kRidge I
///   lambda_i = sn^2 + sf^2 - [Knm Kmm^-1 Kmn]_ii
///
/// @param inducing    Z, one per column                                                [D x m]
/// @param d_inducing  (optional) out: gradient in Z                                    [D x m]
/// @return            +infinity (gradient NaN) where a matrix is not positive definite
double sparseNegativeLogLikelihood(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                                   const Eigen::MatrixXd& targets,
                                   const Hyperparameters& hyperparameters,
                                   Eigen::MatrixXd* d_inducing = nullptr);

/// The GP of these inducing inputs. With B = Kmm + Kmn diag(lambda)^-1 Knm:
///
///   beta = B^-1 Kmn diag(lambda)^-1 y,   GpModel::inverse = Kmm^-1 - B^-1
///
/// @return not ok, with the output's number, where a matrix is not positive definite
GpFit makeSparseGpModel(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                        const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters);

/// Inducing inputs by L-BFGS on sparseNegativeLogLikelihood(), the hyper-parameters staying as they
/// are; then makeSparseGpModel(). If the optimisation does not improve the likelihood, the initial
/// inducing inputs are used, and the message says so.
/// @param start  inducing inputs to start from                                         [D x m]
/// @return       `outputs` has one entry, for all outputs together
GpFit trainSparseGp(const Eigen::MatrixXd& start, const Eigen::MatrixXd& inputs,
                    const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters,
                    int max_iterations, const std::function<void()>& on_evaluation = nullptr);

/// The state that learnGp() keeps from one trial to the next.
struct GpLearnerState {
  Hyperparameters hyperparameters;  ///< last optimum; empty before the first training
  Eigen::MatrixXd inducing;         ///< last inducing inputs; empty before the first sparse GP
};

/// Learns the dynamics of all trials so far: a full GP, from the last optimum onwards, and beyond
/// `max_points` data the sparse one with the full GP's hyper-parameters.
/// @param inputs   one per column                                                      [D x n]
/// @param targets  one per row                                                         [n x E]
/// @param rng      draws gp/training_points, and the first time the inducing inputs to start from
/// @param state    in: of the trial before; out: of this one
/// @throws std::invalid_argument as trainGp(); the state then stays as it was
GpFit learnGp(const GpTrainingOptions& training, const SparseGpOptions& sparse,
              const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, std::mt19937_64* rng,
              GpLearnerState* state, const std::function<void()>& on_evaluation = nullptr);

}  // namespace ddm::pilco
