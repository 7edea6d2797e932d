// Gaussian processes (GPs) of the dynamics, full and sparse, and their training.
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

/// Hyper-parameters of E independent GPs with squared-exponential covariance and one length-scale
/// per input (ARD): theta = [log l_1 ... log l_D, log sf, log sn] of each output is a column. They
/// are natural logarithms, so that any real number is valid.                          [D + 2 x E]
using Hyperparameters = Eigen::MatrixXd;

/// A trained GP: everything needed to compute its predictive distribution at a Gaussian input.
///
///   k_a(x, x') = sf_a^2 exp(-1/2 (x - x')^T Lambda_a^-1 (x - x')),   beta_a = A_a^-1 y_a
///
/// Full GP: A_a = K_a + sn_a^2 I at the training inputs. Sparse GP (FITC): `inputs` holds the
/// inducing inputs Z and `inverse` holds Kmm^-1 - B^-1, so that the formulas of the moments are the
/// same for both kinds.
struct GpModel {
  Eigen::MatrixXd inputs;  ///< one input per column            [D x n]
  Hyperparameters hyperparameters;
  Eigen::MatrixXd beta;                  ///<                  [n x E]
  std::vector<Eigen::MatrixXd> inverse;  ///< A_a^-1, symmetric  E times [n x n]; empty for a
                                         ///< deterministic function, i.e. the RBF policy

  int inputDim() const { return static_cast<int>(inputs.rows()); }
  int outputDim() const { return static_cast<int>(beta.cols()); }
  int numPoints() const { return static_cast<int>(inputs.cols()); }
};

/// Result of a training: the GPs, or the reason why the training failed.
struct GpFit {
  GpModel model;                      ///< empty if the training failed
  std::vector<SolverResult> outputs;  ///< result of each minimisation
  std::string message;                ///< failure or warning; empty if there is none

  bool ok() const { return model.numPoints() > 0; }
  void addMessage(const std::string& text);
  /// Takes the model of a later step of the training, and adds its minimisations and its message.
  void add(GpFit later);
};

/// A line search takes about two evaluations. One that takes many more suffers from rounding
/// errors.
constexpr int kEvaluationsPerIteration = 3;
constexpr double kRidge = 1e-6;  ///< added to the diagonal of Kmm, as published [unit of output^2]
constexpr double kLengthScaleLimit = 100.0;     ///< in units of the input's spread, as published
constexpr double kSignalToNoiseLimit = 1000.0;  ///< signal std / noise std, as published
constexpr int kPenaltyPower = 30;               ///< steepness of the penalty, as published
constexpr double kLogTwoPi = 1.8378770664093453;

/// k(a, b) = signal_std^2 exp(-1/2 sum_d ((a_d - b_d) / length_scales_d)^2) for all pairs.
///
/// The function squares differences of inputs. The expansion |a|^2 - 2 a b + |b|^2 would lose half
/// of the digits for points that lie close together.
/// @param a  one input per column                                                    [D x n_a]
/// @param b  one input per column                                                    [D x n_b]
/// @return   row i, column j: k(a_i, b_j)                                          [n_a x n_b]
Eigen::MatrixXd squaredExponential(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                   const Eigen::VectorXd& length_scales, double signal_std);

/// Sample standard deviation (divisor n - 1) of each row.
/// @pre at least two columns (checked by eigen_assert)
Eigen::VectorXd sampleStd(const Eigen::MatrixXd& samples);

/// Negative log marginal likelihood of one output:
///
///   1/2 y^T A^-1 y + 1/2 log|A| + n/2 log(2 pi),   A = K + sn^2 I
///
/// @param inputs    one input per column                                               [D x n]
/// @param targets   y                                                                      [n]
/// @param theta     column of Hyperparameters                                          [D + 2]
/// @param gradient  (optional) out: gradient with respect to theta                     [D + 2]
/// @return          +infinity (gradient NaN) if A is not positive definite in double
///                  precision, or if theta is not finite
double negativeLogLikelihood(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& targets,
                             const Eigen::VectorXd& theta, Eigen::VectorXd* gradient = nullptr);

/// Penalty on extreme length-scales and on a very small noise:
///
///   sum_d (log(l_d / std_d) / log kLengthScaleLimit)^p + (log(sf / sn) / log kSignalToNoiseLimit)^p
///
/// with p = kPenaltyPower.
/// @param theta      column of Hyperparameters                                         [D + 2]
/// @param input_std  spread of each input                                                  [D]
/// @param gradient   (optional) the gradient is ADDED to it                            [D + 2]
double penalty(const Eigen::VectorXd& theta, const Eigen::VectorXd& input_std,
               Eigen::VectorXd* gradient = nullptr);

/// Initial hyper-parameters of the first training: length-scales = spread of the inputs, signal =
/// spread of the target, noise = a tenth of the signal.
/// @param inputs   one input per column                                                [D x n]
/// @param targets  one target per row                                                  [n x E]
/// @throws std::invalid_argument naming the fault of the data: fewer than two points, a number that
///         is not finite, or an input or target that is the same in all points
Hyperparameters initialHyperparameters(const Eigen::MatrixXd& inputs,
                                       const Eigen::MatrixXd& targets);

/// The GP with given hyper-parameters: computes beta = A^-1 y and A^-1 for each output.
/// @return not ok, naming the output, if A is not positive definite in double precision
GpFit makeGpModel(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                  const Hyperparameters& hyperparameters);

/// Trains each output separately with BFGS on negativeLogLikelihood() + penalty(), without
/// restarts.
///
/// Data may contain repeated points, because the penalty keeps the noise large enough. If the
/// objective cannot be evaluated at `start` (a covariance is not positive definite), the training
/// begins at initialHyperparameters() instead, and the message says so.
/// @param max_iterations  limit for each output
/// @param start           previous optimum; empty: initialHyperparameters()
/// @param on_evaluation   (optional) called after each evaluation of an objective
/// @throws std::invalid_argument as initialHyperparameters()
GpFit trainGp(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, int max_iterations,
              const Hyperparameters& start = {},
              const std::function<void()>& on_evaluation = nullptr);

/// Negative log marginal likelihood of all outputs together under FITC:
///
///   sum_a  1/2 y_a^T C_a^-1 y_a + 1/2 log|C_a| + n/2 log(2 pi)
///   C = Knm Kmm^-1 Kmn + diag(lambda),   Kmm = k(Z, Z) + kRidge I
///   lambda_i = sn^2 + sf^2 - [Knm Kmm^-1 Kmn]_ii
///
/// @param inducing    Z, one inducing input per column                                 [D x m]
/// @param d_inducing  (optional) out: gradient with respect to Z                       [D x m]
/// @return            +infinity (gradient NaN) if a matrix is not positive definite
double sparseNegativeLogLikelihood(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                                   const Eigen::MatrixXd& targets,
                                   const Hyperparameters& hyperparameters,
                                   Eigen::MatrixXd* d_inducing = nullptr);

/// The sparse GP with given inducing inputs. With B = Kmm + Kmn diag(lambda)^-1 Knm:
///
///   beta = B^-1 Kmn diag(lambda)^-1 y,   GpModel::inverse = Kmm^-1 - B^-1
///
/// @return not ok, naming the output, if a matrix is not positive definite
GpFit makeSparseGpModel(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                        const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters);

/// Optimises the inducing inputs with L-BFGS on sparseNegativeLogLikelihood() for fixed
/// hyper-parameters, then calls makeSparseGpModel(). If the optimisation does not improve the
/// likelihood, the initial inducing inputs are used, and the message says so.
/// @param start  initial inducing inputs                                               [D x m]
/// @return       `outputs` has one entry for all outputs together
GpFit trainSparseGp(const Eigen::MatrixXd& start, const Eigen::MatrixXd& inputs,
                    const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters,
                    int max_iterations, const std::function<void()>& on_evaluation = nullptr);

/// State of learnGp() between two trials.
struct GpLearnerState {
  Hyperparameters hyperparameters;  ///< latest optimum; empty before the first training
  Eigen::MatrixXd inducing;         ///< latest inducing inputs; empty before the first sparse GP
};

/// Learns the dynamics from all trials so far. The training of the full GP begins at the latest
/// optimum. With more than `max_points` samples, a sparse GP with the hyper-parameters of the full
/// GP replaces the full GP.
/// @param inputs   one input per column                                                [D x n]
/// @param targets  one target per row                                                  [n x E]
/// @param rng      draws the points for the hyper-parameters and the first inducing inputs
/// @param state    in: state after the previous trial; out: state after this trial
/// @pre the sizes of the state fit the data (checked by eigen_assert)
/// @throws std::invalid_argument as trainGp(); the state is then unchanged
GpFit learnGp(const PilcoOptions& options, const Eigen::MatrixXd& inputs,
              const Eigen::MatrixXd& targets, std::mt19937_64* rng, GpLearnerState* state,
              const std::function<void()>& on_evaluation = nullptr);

}  // namespace ddm::pilco
