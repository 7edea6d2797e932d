// Sparse GP (FITC): a few inducing inputs instead of all training inputs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "ddm_pilco/gp_training.h"

namespace ddm::pilco {

/// Block `sparse_gp`.
struct SparseGpOptions {
  int max_points = 300;         ///< more data than this: as many inducing inputs [-]
  int first_iterations = 1500;  ///< of L-BFGS on the inducing inputs, from a random subset [-]
  int max_iterations = 500;     ///< the same, from the inducing inputs of the trial before [-]
  double ridge = 1e-6;          ///< added to the diagonal of Kmm [unit of the output squared]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("max_points", max_points);
    visitor("first_iterations", first_iterations);
    visitor("max_iterations", max_iterations);
    visitor("ridge", ridge);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// Negative log marginal likelihood of all outputs together under FITC:
///
///   sum_a  1/2 y_a^T C_a^-1 y_a + 1/2 log|C_a| + n/2 log(2 pi)
///   C = Knm Kmm^-1 Kmn + diag(lambda),   Kmm = k(Z, Z) + ridge I
///   lambda_i = sn^2 + sf^2 - [Knm Kmm^-1 Kmn]_ii
///
/// @param inducing         Z, one per column                                           [D x m]
/// @param inputs           one per column                                              [D x n]
/// @param targets          one per row                                                 [n x E]
/// @param d_inducing       (optional) out: gradient in Z                               [D x m]
/// @return                 +infinity (gradient NaN) where a matrix is not positive definite
/// @pre sizes fit (checked by eigen_assert, i.e. in debug builds only)
double sparseNegativeLogLikelihood(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                                   const Eigen::MatrixXd& targets,
                                   const Hyperparameters& hyperparameters, double ridge,
                                   Eigen::MatrixXd* d_inducing = nullptr);

/// The GP that these inducing inputs stand for. With B = Kmm + Kmn diag(lambda)^-1 Knm:
///
///   beta = B^-1 Kmn diag(lambda)^-1 y,   GpModel::inverse = Kmm^-1 - B^-1
///
/// @return not ok, with the output's number, where a matrix is not positive definite
/// @throws std::invalid_argument if sizes do not fit or anything is not finite
GpFit makeSparseGpModel(const Eigen::MatrixXd& inducing, const Eigen::MatrixXd& inputs,
                        const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters,
                        double ridge);

/// `count` different columns of `inputs`, drawn at random.
/// @throws std::invalid_argument if there are fewer
Eigen::MatrixXd randomSubset(const Eigen::MatrixXd& inputs, int count, std::mt19937_64* rng);

/// Inducing inputs by L-BFGS on sparseNegativeLogLikelihood(), the hyper-parameters staying as they
/// are; then makeSparseGpModel(). If the optimisation gets nowhere, the start is used and the
/// message says so.
/// @param start    inducing inputs to start from                                       [D x m]
/// @param on_evaluation  (optional) called after each evaluation of the likelihood
/// @return         `outputs` has one entry, for all outputs together
/// @throws std::invalid_argument as makeSparseGpModel()
GpFit trainSparseGp(const Eigen::MatrixXd& start, const Eigen::MatrixXd& inputs,
                    const Eigen::MatrixXd& targets, const Hyperparameters& hyperparameters,
                    int max_iterations, double ridge,
                    const std::function<void()>& on_evaluation = nullptr);

/// What GpLearner carries from trial to trial. Saved and handed to another learner, this one goes
/// on where the first stopped.
struct GpLearnerState {
  Hyperparameters hyperparameters;  ///< last optimum; empty before the first training
  Eigen::MatrixXd inducing;         ///< last inducing inputs; empty before the first sparse GP
};

/// Learns the dynamics trial after trial: a full GP, from the last optimum onwards, and beyond
/// `max_points` data the sparse one with the full GP's hyper-parameters.
class GpLearner {
 public:
  /// @throws std::invalid_argument if the options are invalid
  GpLearner(const GpTrainingOptions& training, const SparseGpOptions& sparse,
            GpLearnerState state = {});

  /// @param inputs   of all trials so far, one per column                              [D x n]
  /// @param targets  one per row                                                       [n x E]
  /// @param rng      draws gp/training_points, and the first time the inducing inputs to start from
  /// @param on_evaluation  (optional) called after each evaluation of an objective
  /// @throws std::invalid_argument as trainGp() and trainSparseGp(); the state then stays as it was
  GpFit learn(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, std::mt19937_64* rng,
              const std::function<void()>& on_evaluation = nullptr);

  const GpLearnerState& state() const { return state_; }

 private:
  GpFit trainFull(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                  std::mt19937_64* rng, const std::function<void()>& on_evaluation) const;

  GpTrainingOptions training_;
  SparseGpOptions sparse_;
  GpLearnerState state_;
};

}  // namespace ddm::pilco
