// PILCO's policy: an RBF network whose output is squashed by two sines.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/policy.h"

#include <cmath>
#include <limits>
#include <utility>

#include "pilco/state_cost.h"

namespace ddm::pilco {
namespace {

using ConstMap = Eigen::Map<const Eigen::MatrixXd>;

struct Wave {
  double factor;  // k
  double weight;  // w_k
};

constexpr Wave kWaves[] = {{1.0, 9.0 / 8.0}, {3.0, 1.0 / 8.0}};

}  // namespace

RbfPolicy::RbfPolicy(int input_dim, int output_dim, int num_centres)
    : input_dim_(input_dim), output_dim_(output_dim), num_centres_(num_centres) {
  setParameters(Eigen::VectorXd::Zero(input_dim * output_dim + num_centres * input_dim +
                                      num_centres * output_dim));
}

Eigen::VectorXd RbfPolicy::packParameters(const Eigen::MatrixXd& log_length_scales,
                                          const Eigen::MatrixXd& centres,
                                          const Eigen::MatrixXd& targets) {
  eigen_assert(centres.rows() == log_length_scales.rows() && centres.cols() == targets.rows());
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
  eigen_assert(parameters.size() == num_scales + num_centres_ * (input_dim_ + output_dim_));
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

Moments RbfPolicy::predict(const Gaussian& input) const {
  Moments output = network_->predict(input);
  output.covariance.diagonal().array() += kJitter;
  return output;
}

Gaussian RbfPolicy::backward(const Gaussian& input, const Moments& d_output,
                             Eigen::VectorXd* d_parameters) const {
  GpMoments::Tape tape;
  network_->predict(input, &tape);
  if (d_parameters != nullptr) {
    eigen_assert(d_parameters->size() == parameters_.size());
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

/// Adds the derivatives through beta = A^-1 t with A = K + 1e-4 I: dJ/dt = A^-1 dJ/dbeta and
/// dJ/dA = -(dJ/dt) beta^T. With H_ij = [dJ/dA]_ij K_ij:
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
    // Sums of (c_i - c_j)^2 and of c_i - c_j over all pairs. The centres are columns.
    const Eigen::MatrixXd differences = network.inputs * sums.asDiagonal() - network.inputs * both;
    d_network->inputs -= precisions.asDiagonal() * differences;
    d_network->log_length_scales.col(a) +=
        precisions.cwiseProduct(network.inputs.cwiseProduct(differences).rowwise().sum());
  }
}

Squashing::Squashing(Eigen::VectorXd max_control) : max_control_(std::move(max_control)) {
  eigen_assert((max_control_.array() > 0.0).all());
}

Moments Squashing::predict(const Gaussian& input) const {
  const Eigen::VectorXd& m = input.mean;
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  Moments output = constantMoments(dim(), dim());
  for (int i = 0; i < dim(); ++i) {
    for (const Wave& k : kWaves) {
      const double scale =
          max_control_[i] * k.weight * std::exp(-0.5 * k.factor * k.factor * s(i, i));
      output.mean[i] += scale * std::sin(k.factor * m[i]);
      output.gain(i, i) += scale * k.factor * std::cos(k.factor * m[i]);
    }
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (const Wave& k : kWaves) {
        for (const Wave& l : kWaves) {
          sum += k.weight * l.weight *
                 sineCovariance(k.factor * m[i], l.factor * m[j], k.factor * k.factor * s(i, i),
                                l.factor * l.factor * s(j, j), k.factor * l.factor * s(i, j));
        }
      }
      output.covariance(i, j) = max_control_[i] * max_control_[j] * sum;
      output.covariance(j, i) = output.covariance(i, j);
    }
  }
  return output;
}

Moments Squashing::applyTo(const Moments& y) const {
  Moments output = predict(marginal(y));
  output.gain = y.gain * output.gain;
  return output;
}

Gaussian Squashing::backward(const Gaussian& input, const Moments& d_output) const {
  const Eigen::VectorXd& m = input.mean;
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  Gaussian d_input = constantGaussian(dim());
  for (int i = 0; i < dim(); ++i) {
    const double d_mean = d_output.mean[i];
    const double d_gain = d_output.gain(i, i);
    for (const Wave& k : kWaves) {
      const double square = k.factor * k.factor;
      const double scale = max_control_[i] * k.weight * std::exp(-0.5 * square * s(i, i));
      const double sine = scale * std::sin(k.factor * m[i]);
      const double cosine = scale * k.factor * std::cos(k.factor * m[i]);
      d_input.mean[i] += d_mean * cosine - d_gain * square * sine;
      d_input.covariance(i, i) -= 0.5 * square * (d_mean * sine + d_gain * cosine);
    }
    for (int j = 0; j < dim(); ++j) {
      const double weight = max_control_[i] * max_control_[j] * d_output.covariance(i, j);
      for (const Wave& k : kWaves) {
        for (const Wave& l : kWaves) {
          SineCovarianceGradient gradient;
          sineCovariance(k.factor * m[i], l.factor * m[j], k.factor * k.factor * s(i, i),
                         l.factor * l.factor * s(j, j), k.factor * l.factor * s(i, j), &gradient);
          const double w = weight * k.weight * l.weight;
          d_input.mean[i] += w * k.factor * gradient.mean_a;
          d_input.mean[j] += w * l.factor * gradient.mean_b;
          d_input.covariance(i, i) += w * k.factor * k.factor * gradient.variance;
          d_input.covariance(j, j) += w * l.factor * l.factor * gradient.variance;
          d_input.covariance(i, j) += w * k.factor * l.factor * gradient.covariance;
        }
      }
    }
  }
  d_input.covariance = symmetricPart(d_input.covariance);
  return d_input;
}

SquashedPolicy::SquashedPolicy(RbfPolicy policy, const Eigen::VectorXd& max_control)
    : policy_(std::move(policy)), squashing_(max_control) {
  eigen_assert(policy_.outputDim() == squashing_.dim());
}

Moments SquashedPolicy::predict(const Gaussian& input) const {
  return squashing_.applyTo(policy_.predict(input));
}

Gaussian SquashedPolicy::backward(const Gaussian& input, const Moments& d_output,
                                  Eigen::VectorXd* d_parameters) const {
  const Moments before = policy_.predict(input);
  const Gaussian unbounded = marginal(before);
  const Eigen::MatrixXd slopes = squashing_.predict(unbounded).gain;
  const Gaussian d_unbounded = squashing_.backward(
      unbounded,
      Moments{d_output.mean, d_output.covariance, before.gain.transpose() * d_output.gain});
  return policy_.backward(input,
                          Moments{d_unbounded.mean, d_unbounded.covariance, d_output.gain * slopes},
                          d_parameters);
}

Eigen::VectorXd SquashedPolicy::control(const Eigen::VectorXd& features) const {
  const Eigen::VectorXd& bound = squashing_.maxControl();
  return predict(known(features))
      .mean.cwiseMin(bound)
      .cwiseMax(-bound);  // removes rounding errors at the flat tops
}

}  // namespace ddm::pilco
