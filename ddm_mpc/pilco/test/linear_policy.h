// The simplest policy, for tests: with it state and control are jointly Gaussian.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_pilco/messages.h"
#include "ddm_pilco/policy.h"

namespace ddm {
namespace pilco {

/// M = W m + b,  S = W s W^T,  V = W^T (Deisenroth, 2010).
/// Parameters: W [U x D] by columns, then b [U].
class LinearPolicy : public Policy {
 public:
  /// @throws std::invalid_argument if a size is < 1
  LinearPolicy(int input_dim, int output_dim);

  int inputDim() const override { return static_cast<int>(weights_.cols()); }
  int outputDim() const override { return static_cast<int>(weights_.rows()); }
  Eigen::VectorXd parameters() const override { return parameters_; }
  void setParameters(const Eigen::VectorXd& parameters) override;
  Moments predict(const Gaussian& input) override;
  Gaussian backward(const Gaussian& input, const Moments& d_output,
                    Eigen::VectorXd* d_parameters) override;

 private:
  Eigen::VectorXd parameters_;
  Eigen::MatrixXd weights_;  // [U x D]
};

inline LinearPolicy::LinearPolicy(int input_dim, int output_dim) {
  require(input_dim >= 1 && output_dim >= 1, "linear policy: inputs and outputs must be >= 1");
  weights_ = Eigen::MatrixXd::Zero(output_dim, input_dim);
  parameters_ = Eigen::VectorXd::Zero(output_dim * (input_dim + 1));
}

inline void LinearPolicy::setParameters(const Eigen::VectorXd& parameters) {
  requireShape(parameters, parameters_.size(), 1, "linear policy: the parameters");
  parameters_ = parameters;
  weights_ = Eigen::Map<const Eigen::MatrixXd>(parameters.data(), outputDim(), inputDim());
}

inline Moments LinearPolicy::predict(const Gaussian& input) {
  requireSize(input, inputDim(), "linear policy");
  return Moments{weights_ * input.mean + parameters_.tail(outputDim()),
                 weights_ * symmetricPart(input.covariance) * weights_.transpose(),
                 weights_.transpose()};
}

inline Gaussian LinearPolicy::backward(const Gaussian& input, const Moments& d_output,
                                       Eigen::VectorXd* d_parameters) {
  requireSize(input, inputDim(), "linear policy");
  requireSize(d_output, inputDim(), outputDim(), "linear policy");
  const Eigen::MatrixXd d_covariance = symmetricPart(d_output.covariance);
  if (d_parameters != nullptr) {
    requireShape(*d_parameters, parameters_.size(), 1, "linear policy: the gradient");
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
