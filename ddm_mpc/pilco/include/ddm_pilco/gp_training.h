// Training of Gaussian processes: hyper-parameters that maximise the marginal likelihood.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/minimise.h>

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "ddm_pilco/gp_model.h"

namespace ddm::pilco {

/// Block `gp`: training of one GP for each output. Defaults are those of the published PILCO code.
struct GpTrainingOptions {
  int max_iterations = 300;               ///< of BFGS, for each output [-]
  int training_points = 0;                ///< drawn at random to learn from; 0: all [-]
  double length_scale_limit = 100.0;      ///< curb: length-scales up to limit x spread of input [-]
  double signal_to_noise_limit = 1000.0;  ///< curb: signal std up to limit x noise std [-]
  int curb_power = 30;                    ///< steepness of the curb, even [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("max_iterations", max_iterations);
    visitor("training_points", training_points);
    visitor("length_scale_limit", length_scale_limit);
    visitor("signal_to_noise_limit", signal_to_noise_limit);
    visitor("curb_power", curb_power);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

/// A line search takes about two evaluations; one that takes many more is lost in rounding errors.
/// Limit for minimisations whose evaluations are costly.
constexpr int kEvaluationsPerIteration = 3;

/// @throws std::invalid_argument that names the first thing wrong with inputs [D x n] and targets
///         [n x E]: no data, sizes that do not fit, NaN or infinity (with its place)
void requireFiniteData(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets);

/// @throws std::invalid_argument unless these are finite and for so many inputs and outputs
void requireHyperparameters(const Hyperparameters& hyperparameters, Eigen::Index input_dim,
                            Eigen::Index output_dim);

/// Negative log marginal likelihood of one output, in the log parameters
/// theta = [log l_1 ... log l_D, log sf, log sn]:
///
///   1/2 y^T A^-1 y + 1/2 log|A| + n/2 log(2 pi),   A = K + sn^2 I
///
/// @param inputs    one per column                                                     [D x n]
/// @param targets   y                                                                      [n]
/// @param theta     log length-scales, log signal std, log noise std                   [D + 2]
/// @param gradient  (optional) out: with respect to theta                              [D + 2]
/// @return          +infinity (gradient NaN) where A is not positive definite in double
///                  precision, or theta is not finite
/// @pre sizes as above (checked by eigen_assert, i.e. in debug builds only)
double negativeLogLikelihood(const Eigen::MatrixXd& inputs, const Eigen::VectorXd& targets,
                             const Eigen::VectorXd& theta, Eigen::VectorXd* gradient = nullptr);

/// The curb: what keeps training from absurd length-scales and from a noise of next to nothing.
///
///   sum_d (log(l_d / std_d) / log length_scale_limit)^p
///     + (log(sf / sn) / log signal_to_noise_limit)^p,   p = curb_power
///
/// @param theta      as above                                                          [D + 2]
/// @param input_std  spread of each input                                                  [D]
/// @param gradient   (optional) the gradient is ADDED to it                            [D + 2]
double curb(const Eigen::VectorXd& theta, const Eigen::VectorXd& input_std,
            const GpTrainingOptions& options, Eigen::VectorXd* gradient = nullptr);

/// Sample standard deviation (divisor n - 1) of each row.
/// @throws std::invalid_argument for fewer than two columns
Eigen::VectorXd sampleStd(const Eigen::MatrixXd& samples);

/// theta of output number `output`.                                                    [D + 2]
Eigen::VectorXd thetaOf(const Hyperparameters& hyperparameters, int output);

/// Where the first training starts: length-scales = spread of the inputs, signal = spread of the
/// target, noise = a tenth of it.
/// @param inputs   one per column                                                      [D x n]
/// @param targets  one per row                                                         [n x E]
/// @throws std::invalid_argument that names what makes the data unusable, see trainGp()
Hyperparameters initialHyperparameters(const Eigen::MatrixXd& inputs,
                                       const Eigen::MatrixXd& targets);

/// GPs, or why there are none.
struct GpFit {
  bool ok = false;               ///< whether `model` can be used
  GpModel model;                 ///< empty if not
  std::vector<Minimum> outputs;  ///< how it went: one for each output that was trained
  std::string message;           ///< what failed, or was noteworthy; empty: all went well

  void addMessage(const std::string& text);
};

/// The GP of these hyper-parameters: beta = A^-1 y and A^-1 for each output.
/// @param inputs   one per column                                                      [D x n]
/// @param targets  one per row                                                         [n x E]
/// @return not ok, with the output's number, where A is not positive definite in double precision
/// @throws std::invalid_argument if sizes do not fit or the data are not finite
GpFit makeGpModel(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
                  const Hyperparameters& hyperparameters);

/// Trains each output by itself by BFGS on negativeLogLikelihood() + curb(), without restarts.
///
/// Data with repeated points are fine: the curb keeps the noise large enough. Where the start
/// cannot be evaluated (a covariance that is not positive definite), initialHyperparameters() is
/// tried instead, and the message says so.
/// @param inputs   one per column                                                      [D x n]
/// @param targets  one per row                                                         [n x E]
/// @param start    (optional) previous optimum; null: initialHyperparameters()
/// @param on_evaluation  (optional) called after each evaluation of an objective: a sign of life
/// @throws std::invalid_argument if the options are invalid, sizes do not fit, there are fewer than
///         two points, the data are not finite, or an input or a target is the same in all points
GpFit trainGp(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets,
              const GpTrainingOptions& options, const Hyperparameters* start = nullptr,
              const std::function<void()>& on_evaluation = nullptr);

}  // namespace ddm::pilco
