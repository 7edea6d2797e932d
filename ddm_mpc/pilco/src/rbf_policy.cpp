// RBF-network policy: the mean of a GP with free pseudo-data.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/rbf_policy.h"

#include <cmath>
#include <limits>
#include <utility>

#include "ddm_pilco/messages.h"

namespace ddm::pilco {

using ConstMap = Eigen::Map<const Eigen::MatrixXd>;

RbfPolicy::RbfPolicy(int input_dim, int output_dim, int num_centres)
    : input_dim_(input_dim), output_dim_(output_dim), num_centres_(num_centres) {
  require(input_dim >= 1 && output_dim >= 1 && num_centres >= 1,
          "rbf policy: inputs, outputs and centres must be >= 1");
  setParameters(Eigen::VectorXd::Zero(input_dim * output_dim + num_centres * input_dim +
                                      num_centres * output_dim));
}

Eigen::VectorXd RbfPolicy::packParameters(const Eigen::MatrixXd& log_length_scales,
                                          const Eigen::MatrixXd& centres,
                                          const Eigen::MatrixXd& targets) {
  require(centres.rows() == log_length_scales.rows() && centres.cols() == targets.rows() &&
              targets.cols() == log_length_scales.cols(),
          "rbf policy: length-scales, centres and targets do not fit");
  const Eigen::MatrixXd by_coordinate = centres.transpose();
  Eigen::VectorXd parameters(log_length_scales.size() + centres.size() + targets.size());
  parameters << Eigen::Map<const Eigen::VectorXd>(log_length_scales.data(),
                                                  log_length_scales.size()),
      Eigen::Map<const Eigen::VectorXd>(by_coordinate.data(), by_coordinate.size()),
      Eigen::Map<const Eigen::VectorXd>(targets.data(), targets.size());
  return parameters;
}

void RbfPolicy::setParameters(const Eigen::VectorXd& parameters) {
  const int num_scales = input_dim_ * output_dim_;
  requireShape(parameters, num_scales + num_centres_ * (input_dim_ + output_dim_), 1,
               "rbf policy: the parameters");
  parameters_ = parameters;
  const double* const data = parameters_.data();
  const ConstMap centres(data + num_scales, num_centres_, input_dim_);
  const ConstMap targets(data + num_scales + centres.size(), num_centres_, output_dim_);

  GpModel network;
  network.inputs = centres.transpose();
  network.hyperparameters.log_length_scales = ConstMap(data, input_dim_, output_dim_);
  network.hyperparameters.log_signal_std = Eigen::VectorXd::Zero(output_dim_);
  network.hyperparameters.log_noise_std =
      Eigen::VectorXd::Constant(output_dim_, 0.5 * std::log(kNoiseVariance));
  network.beta.resize(num_centres_, output_dim_);
  kernels_.resize(output_dim_);
  factorisations_.resize(output_dim_);
  const Eigen::MatrixXd scales = network.hyperparameters.log_length_scales.array().exp();
  for (int a = 0; a < output_dim_; ++a) {
    kernels_[a] = squaredExponential(network.inputs, network.inputs, scales.col(a), 1.0);
    Eigen::MatrixXd A = kernels_[a];
    A.diagonal().array() += kNoiseVariance;
    factorisations_[a].compute(A);
    if (factorisations_[a].info() == Eigen::Success && parameters_.allFinite()) {
      network.beta.col(a) = factorisations_[a].solve(targets.col(a));
    } else {
      network.beta.col(a).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  network_ = std::make_unique<GpMoments>(std::move(network));
}

Moments RbfPolicy::predict(const Gaussian& input) {
  Moments output = network_->predict(input);
  output.covariance.diagonal().array() += kJitter;
  return output;
}

Gaussian RbfPolicy::backward(const Gaussian& input, const Moments& d_output,
                             Eigen::VectorXd* d_parameters) {
  GpMoments::Tape tape;
  network_->predict(input, &tape);
  if (d_parameters != nullptr) {
    requireShape(*d_parameters, parameters_.size(), 1, "rbf policy: the gradient");
    GpGradient d_network{Eigen::MatrixXd::Zero(input_dim_, num_centres_),
                         Eigen::MatrixXd::Zero(num_centres_, output_dim_),
                         Eigen::MatrixXd::Zero(input_dim_, output_dim_)};
    network_->backwardToModel(tape, d_output, &d_network);
    Eigen::MatrixXd d_targets;
    addThroughBeta(&d_network, &d_targets);
    *d_parameters += packParameters(d_network.log_length_scales, d_network.inputs, d_targets);
  }
  return network_->backward(tape, d_output);
}

/// beta = A^-1 t with A = K + 1e-4 I: dJ/dt = A^-1 dJ/dbeta and dJ/dA = -(dJ/dt) beta^T. With
/// H_ij = [dJ/dA]_ij K_ij, and differences of centres c_i - c_j:
///
///   dJ/dlog l_d = sum_ij H_ij (c_id - c_jd)^2 / l_d^2
///   dJ/dc_i     = -sum_j (H_ij + H_ji) Lambda^-1 (c_i - c_j)
void RbfPolicy::addThroughBeta(GpGradient* d_network, Eigen::MatrixXd* d_targets) const {
  const GpModel& network = network_->model();
  d_targets->resize(num_centres_, output_dim_);
  for (int a = 0; a < output_dim_; ++a) {
    d_targets->col(a) = factorisations_[a].solve(d_network->beta.col(a));
    const Eigen::MatrixXd H =
        -(d_targets->col(a) * network.beta.col(a).transpose()).cwiseProduct(kernels_[a]);
    const Eigen::MatrixXd both = H + H.transpose();
    const Eigen::VectorXd sums = both.rowwise().sum();
    const Eigen::VectorXd precisions =
        (-2.0 * network.hyperparameters.log_length_scales.col(a).array()).exp();
    // Summed over all pairs: (c_i - c_j)^2 and c_i - c_j, centres in columns.
    const Eigen::MatrixXd differences = network.inputs * sums.asDiagonal() - network.inputs * both;
    d_network->inputs -= precisions.asDiagonal() * differences;
    d_network->log_length_scales.col(a) +=
        precisions.cwiseProduct(network.inputs.cwiseProduct(differences).rowwise().sum());
  }
}

}  // namespace ddm::pilco
