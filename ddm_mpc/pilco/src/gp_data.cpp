// What data must be like before a GP is made of them.
// SPDX-License-Identifier: BSD-3-Clause
#include "gp_data.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "ddm_pilco/gp_training.h"

namespace ddm {
namespace pilco {
namespace {

/// @param samples  one per column
void requireFinite(const Eigen::MatrixXd& samples, const std::string& name) {
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    for (Eigen::Index d = 0; d < samples.rows(); ++d) {
      if (std::isfinite(samples(d, i))) continue;
      throw std::invalid_argument(name + " " + std::to_string(d + 1) + " of point " +
                                  std::to_string(i + 1) + " of " + std::to_string(samples.cols()) +
                                  " must be a finite number, got " + std::to_string(samples(d, i)));
    }
  }
}

void requireFiniteParameter(double value, const std::string& name, Eigen::Index output) {
  if (std::isfinite(value)) return;
  throw std::invalid_argument("the log of the " + name + " for output " +
                              std::to_string(output + 1) + " must be a finite number, got " +
                              std::to_string(value));
}

void requireVaried(const Eigen::MatrixXd& samples, const std::string& name) {
  const Eigen::VectorXd spread = sampleStd(samples);
  for (Eigen::Index d = 0; d < samples.rows(); ++d) {
    const std::string which = name + " " + std::to_string(d + 1);
    if (!std::isfinite(spread[d])) {
      throw std::invalid_argument(which + " is too large: its variance is beyond double precision");
    }
    // The extremes, as the spread of equal numbers may be a rounding error.
    if (spread[d] > 0.0 && samples.row(d).minCoeff() < samples.row(d).maxCoeff()) continue;
    throw std::invalid_argument(
        which + " is " + std::to_string(samples(d, 0)) + " in all " +
        std::to_string(samples.cols()) +
        " points: nothing can be learnt from it. Leave it out, or record data "
        "in which it changes; a feature of images: learn fewer of them");
  }
}

}  // namespace

void requireFiniteData(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets) {
  if (inputs.size() == 0 || targets.size() == 0) {
    throw std::invalid_argument("a GP needs data, got " + std::to_string(inputs.cols()) +
                                " points with " + std::to_string(inputs.rows()) + " inputs and " +
                                std::to_string(targets.cols()) + " targets");
  }
  if (inputs.cols() != targets.rows()) {
    throw std::invalid_argument("inputs and targets must be of the same points, got " +
                                std::to_string(inputs.cols()) + " and " +
                                std::to_string(targets.rows()));
  }
  requireFinite(inputs, "input");
  requireFinite(targets.transpose(), "target");
}

void requireVariedData(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets) {
  requireFiniteData(inputs, targets);
  if (inputs.cols() < 2) {
    throw std::invalid_argument("training a GP needs at least 2 points, got 1");
  }
  requireVaried(inputs, "input");
  requireVaried(targets.transpose(), "target");
}

void requireHyperparameters(const Hyperparameters& hyperparameters, Eigen::Index input_dim,
                            Eigen::Index output_dim) {
  const bool sizes_fit = hyperparameters.log_length_scales.rows() == input_dim &&
                         hyperparameters.log_length_scales.cols() == output_dim &&
                         hyperparameters.log_signal_std.size() == output_dim &&
                         hyperparameters.log_noise_std.size() == output_dim;
  if (!sizes_fit) {
    throw std::invalid_argument(
        "the hyper-parameters must be for " + std::to_string(input_dim) + " inputs and " +
        std::to_string(output_dim) + " outputs, got length-scales for " +
        std::to_string(hyperparameters.log_length_scales.rows()) + " and " +
        std::to_string(hyperparameters.log_length_scales.cols()) + ", " +
        std::to_string(hyperparameters.log_signal_std.size()) + " signal stds and " +
        std::to_string(hyperparameters.log_noise_std.size()) + " noise stds");
  }
  for (Eigen::Index a = 0; a < output_dim; ++a) {
    for (Eigen::Index d = 0; d < input_dim; ++d) {
      requireFiniteParameter(hyperparameters.log_length_scales(d, a),
                             "length-scale of input " + std::to_string(d + 1), a);
    }
    requireFiniteParameter(hyperparameters.log_signal_std[a], "signal std", a);
    requireFiniteParameter(hyperparameters.log_noise_std[a], "noise std", a);
  }
}

}  // namespace pilco
}  // namespace ddm
