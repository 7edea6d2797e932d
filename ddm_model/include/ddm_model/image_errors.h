// How much of given images a model keeps: in its principal components, and in its features.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>

#include "ddm_model/data_set.h"
#include "ddm_model/ddm.h"

namespace ddm {

/// Distances of each frame of a data set, root mean square over its pixels [grey].
struct ImageErrors {
  Eigen::VectorXd mean;            ///< to the model's mean image                       [N]
  Eigen::VectorXd pca;             ///< to what the principal components keep of it     [N]
  Eigen::VectorXd reconstruction;  ///< to g(g^-1(y))                                   [N]
  /// Mean square of the images along each component, from the model's mean image; divided by that
  /// of the whole images: what share of them each component keeps [-]             [pca_dim]
  Eigen::VectorXd component_share;
  /// Root mean square over all pixels and images of their distance to the mean of these very images
  /// [grey]. 0: they are all the same.
  double variation = 0.0;
};

/// @param data      at least one frame, of the model's image size
/// @param progress  told which fraction is done
/// @throws std::invalid_argument if the images have another size than the model's, or there is none
ImageErrors imageErrors(
    const Ddm& model, const DataSet& data,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace ddm
