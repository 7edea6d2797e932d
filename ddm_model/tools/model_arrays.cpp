// Everything that a model computes with, as arrays by name.
// SPDX-License-Identifier: BSD-3-Clause
#include "model_arrays.h"

#include <ddm_model/networks.h>
#include <ddm_model/per_motor.h>

#include <cstdint>

#include "npy_file.h"

namespace ddm {
namespace {

using Arrays = std::map<std::string, std::string>;

void addNetwork(const Mlp<double>& network, const double* theta, const std::string& name,
                Arrays* out) {
  for (int layer = 0; layer < network.numLayers(); ++layer) {
    const std::string number = std::to_string(layer + 1);
    (*out)[name + "_W" + number] = npyOf(Eigen::MatrixXd(network.weights(theta, layer)));
    (*out)[name + "_b" + number] = npyOf(Eigen::VectorXd(network.biases(theta, layer)));
  }
}

}  // namespace

std::map<std::string, std::string> modelArrays(const Ddm& model) {
  Arrays out;
  const auto add = [&](const std::string& name, const auto& matrix) { out[name] = npyOf(matrix); };
  const auto addNumber = [&](const std::string& name, auto value) {
    out[name] = npyOfNumber(value);
  };
  const ModelOptions& options = model.options();
  addNumber("image_size", std::int64_t{model.imageSize()});
  addNumber("feature_dim", std::int64_t{options.feature_dim});
  addNumber("torque_dim", std::int64_t{model.torqueDim()});
  addNumber("order", std::int64_t{options.order});
  if (options.max_torque.size() == 1) {
    addNumber("max_torque", options.max_torque[0]);
  } else {
    add("max_torque", perMotor(options.max_torque, model.torqueDim(), "model/max_torque"));
  }
  addNumber("residual", std::int64_t{options.residual ? 1 : 0});
  addNumber("increments", std::int64_t{options.increments ? 1 : 0});
  add("pca_mean", model.pca().mean);
  add("pca_basis", model.pca().basis);
  add("pca_variance", model.pca().variance);
  addNumber("pca_scale", static_cast<double>(model.pca().scale));
  const Networks<double> networks(options, model.torqueDim());
  const double* theta = model.theta().data();
  addNetwork(networks.encoder(), networks.encoderOf(theta), "encoder", &out);
  addNetwork(networks.decoder(), networks.decoderOf(theta), "decoder", &out);
  addNetwork(networks.f(), networks.predictorOf(theta), "f", &out);
  if (!model.hasGoal()) return out;
  using Bytes = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>;
  add("goal", Bytes(Eigen::Map<const Bytes>(model.goal().data(),
                                            static_cast<Eigen::Index>(model.goal().size()))));
  add("goal_feature", model.goalFeature());
  return out;
}

}  // namespace ddm
