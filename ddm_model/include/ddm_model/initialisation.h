// Initial parameters: the auto-encoder from layer-wise PCA, the predictor at random.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <random>

#include "ddm_model/networks.h"

namespace ddm {

/// Initial theta (paper, Sec. 2.3, "Initialization"). The auto-encoder is unfolded: encoder layer k
/// and the decoder layer that mirrors it form a pair, which starts as the PCA of that layer's
/// input,
///
///   encoder:  W = c B^T, b = -c B^T m        decoder:  W = B / c, b = m
///
/// with basis B and mean m of the inputs. c gives the leading unit a spread of 0.3, where the arctan
/// is nearly linear; the arctan's output is the input of the next pair. Units beyond the rank of the
/// input have random initial weights, as has the whole auto-encoder without a PCA start, and f.
/// @param scores  PCA scores of all images  [pca_dim x M]
/// @return        theta                     [P]
Eigen::VectorXd initialTheta(const Networks<double>& networks, const Eigen::MatrixXd& scores,
                             bool pca_start, std::mt19937_64* rng);

}  // namespace ddm
