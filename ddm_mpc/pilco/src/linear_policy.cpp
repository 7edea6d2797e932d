// Linear policy: u = W x + b before squashing.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/linear_policy.h"

#include <stdexcept>
#include <string>

namespace ddm {
namespace pilco {

LinearPolicy::LinearPolicy(int input_dim, int output_dim) {
  if (input_dim < 1 || output_dim < 1) {
    throw std::invalid_argument("linear policy: inputs and outputs must be >= 1");
  }
  weights_ = Eigen::MatrixXd::Zero(output_dim, input_dim);
  parameters_ = Eigen::VectorXd::Zero(output_dim * (input_dim + 1));
}

void LinearPolicy::setParameters(const Eigen::VectorXd& parameters) {
  if (parameters.size() != parameters_.size()) {
    throw std::invalid_argument("linear policy: there must be " +
                                std::to_string(parameters_.size()) + " parameters, got " +
                                std::to_string(parameters.size()));
  }
  parameters_ = parameters;
  weights_ = Eigen::Map<const Eigen::MatrixXd>(parameters.data(), outputDim(), inputDim());
}

Moments LinearPolicy::predict(const Gaussian& input) {
  requireSize(input, inputDim(), "linear policy");
  return Moments{weights_ * input.mean + parameters_.tail(outputDim()),
                 weights_ * symmetricPart(input.covariance) * weights_.transpose(),
                 weights_.transpose()};
}

Gaussian LinearPolicy::backward(const Gaussian& input, const Moments& d_output,
                                Eigen::VectorXd* d_parameters) {
  requireSize(input, inputDim(), "linear policy");
  requireSize(d_output, inputDim(), outputDim(), "linear policy");
  const Eigen::MatrixXd d_covariance = symmetricPart(d_output.covariance);
  if (d_parameters != nullptr) {
    if (d_parameters->size() != parameters_.size()) {
      throw std::invalid_argument(
          "linear policy: the gradient has another size than the parameters");
    }
    const Eigen::MatrixXd d_weights =
        d_output.mean * input.mean.transpose() +
        2.0 * d_covariance * weights_ * symmetricPart(input.covariance) + d_output.gain.transpose();
    d_parameters->head(weights_.size()) +=
        Eigen::Map<const Eigen::VectorXd>(d_weights.data(), d_weights.size());
    d_parameters->tail(outputDim()) += d_output.mean;
  }
  return Gaussian{weights_.transpose() * d_output.mean,
                  weights_.transpose() * d_covariance * weights_};
}

}  // namespace pilco
}  // namespace ddm
