// The bare matrix products of one objective with its gradient: what no implementation leaves out.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_model/networks.h>

#include <Eigen/Core>
#include <vector>

namespace ddm {

/// W a, delta a^T and W^T delta of each layer of g^-1, g and f, on random matrices: no activation,
/// no bias, no error. The decoder has twice the samples, the images' features and the predicted.
class MatrixProducts {
 public:
  /// @param num_samples  images that are encoded, and predictions
  /// @param block        so many of them go through all networks before the next ones do
  MatrixProducts(const Networks<float>& networks, Eigen::Index num_samples, Eigen::Index block);

  /// All products once.
  void run();

 private:
  /// One layer on one block.
  struct Layer {
    Eigen::MatrixXf weights, d_weights;  ///< [outputs x inputs]
    Eigen::MatrixXf inputs, d_inputs;    ///< [inputs x samples]
    Eigen::MatrixXf outputs, d_outputs;  ///< [outputs x samples]
    bool needs_d_inputs = true;
  };

  void add(const Mlp<float>& net, Eigen::Index samples, bool needs_d_inputs);

  Eigen::Index num_blocks_;
  std::vector<Layer> layers_;
};

}  // namespace ddm
