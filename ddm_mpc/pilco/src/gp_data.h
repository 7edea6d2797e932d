// Training of GPs, full or sparse: limits, and checks of the data.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/gp_model.h"

namespace ddm {
namespace pilco {

/// A line search takes about two evaluations; one that takes many more is lost in rounding errors.
/// Limit for minimisations whose evaluations are costly.
constexpr int kEvaluationsPerIteration = 3;

/// @param inputs   one per column                                                      [D x n]
/// @param targets  one per row                                                         [n x E]
/// @throws std::invalid_argument that names the first thing wrong: no data, sizes that do not
///         fit, NaN or infinity (with its place)
void requireFiniteData(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets);

/// Moreover at least two points, and no input or target that is the same in all of them.
void requireVariedData(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets);

/// @throws std::invalid_argument unless these are finite hyper-parameters for so many inputs and
///         outputs
void requireHyperparameters(const Hyperparameters& hyperparameters, Eigen::Index input_dim,
                            Eigen::Index output_dim);

}  // namespace pilco
}  // namespace ddm
