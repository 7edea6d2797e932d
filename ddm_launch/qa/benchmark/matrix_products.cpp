// The bare matrix products of one objective with its gradient: what no implementation leaves out.
// SPDX-License-Identifier: BSD-3-Clause
#include "matrix_products.h"

namespace ddm {

MatrixProducts::MatrixProducts(const Networks<float>& networks, Eigen::Index num_samples,
                               Eigen::Index block)
    : num_blocks_((num_samples + block - 1) / block) {
  add(networks.encoder(), block, false);  // nothing is learned before the images
  add(networks.f(), block, true);
  add(networks.decoder(), 2 * block, true);
}

void MatrixProducts::add(const Mlp<float>& net, Eigen::Index samples, bool needs_d_inputs) {
  for (size_t l = 1; l < net.widths().size(); ++l) {
    const int inputs = net.widths()[l - 1], outputs = net.widths()[l];
    Layer layer;
    layer.weights = layer.d_weights = Eigen::MatrixXf::Random(outputs, inputs);
    layer.inputs = layer.d_inputs = Eigen::MatrixXf::Random(inputs, samples);
    layer.outputs = layer.d_outputs = Eigen::MatrixXf::Random(outputs, samples);
    layer.needs_d_inputs = needs_d_inputs || l > 1;
    layers_.push_back(std::move(layer));
  }
}

void MatrixProducts::run() {
  for (Eigen::Index block = 0; block < num_blocks_; ++block) {
    for (Layer& layer : layers_) layer.outputs.noalias() = layer.weights * layer.inputs;
    for (Layer& layer : layers_) {
      layer.d_weights.noalias() += layer.d_outputs * layer.inputs.transpose();
      if (layer.needs_d_inputs) {
        layer.d_inputs.noalias() = layer.weights.transpose() * layer.d_outputs;
      }
    }
  }
}

}  // namespace ddm
