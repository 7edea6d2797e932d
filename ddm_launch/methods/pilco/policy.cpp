// PILCO's policy: an RBF network whose output is squashed by two sines.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/policy.h"

#include <cmath>
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

Moments squash(const Gaussian& x, const Eigen::VectorXd& max_control) {
  eigen_assert((max_control.array() > 0.0).all());
  const int dim = static_cast<int>(max_control.size());
  const Eigen::VectorXd& m = x.mean;
  const Eigen::MatrixXd s = symmetricPart(x.covariance);
  Moments output = constantMoments(dim, dim);
  for (int i = 0; i < dim; ++i) {
    for (const Wave& k : kWaves) {
      const double scale =
          max_control[i] * k.weight * std::exp(-0.5 * k.factor * k.factor * s(i, i));
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
      output.covariance(i, j) = max_control[i] * max_control[j] * sum;
      output.covariance(j, i) = output.covariance(i, j);
    }
  }
  return output;
}

Gaussian squashBackward(const Gaussian& x, const Eigen::VectorXd& max_control,
                        const Moments& d_output) {
  const int dim = static_cast<int>(max_control.size());
  const Eigen::VectorXd& m = x.mean;
  const Eigen::MatrixXd s = symmetricPart(x.covariance);
  Gaussian d_input = constantGaussian(dim);
  for (int i = 0; i < dim; ++i) {
    const double d_mean = d_output.mean[i];
    const double d_gain = d_output.gain(i, i);
    for (const Wave& k : kWaves) {
      const double square = k.factor * k.factor;
      const double scale = max_control[i] * k.weight * std::exp(-0.5 * square * s(i, i));
      const double sine = scale * std::sin(k.factor * m[i]);
      const double cosine = scale * k.factor * std::cos(k.factor * m[i]);
      d_input.mean[i] += d_mean * cosine - d_gain * square * sine;
      d_input.covariance(i, i) -= 0.5 * square * (d_mean * sine + d_gain * cosine);
    }
    for (int j = 0; j < dim; ++j) {
      const double weight = max_control[i] * max_control[j] * d_output.covariance(i, j);
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

RbfPolicy::RbfPolicy(int input_dim, int num_centres, Eigen::VectorXd max_control)
    : input_dim_(input_dim), num_centres_(num_centres), max_control_(std::move(max_control)) {
  setParameters(Eigen::VectorXd::Zero(input_dim * outputDim() + num_centres * input_dim +
                                      num_centres * outputDim()));
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
  const int outputs = outputDim();
  const int num_scales = input_dim_ * outputs;
  eigen_assert(parameters.size() == num_scales + num_centres_ * (input_dim_ + outputs));
  parameters_ = parameters;
  const double* const data = parameters_.data();
  const ConstMap centres(data + num_scales, num_centres_, input_dim_);
  const ConstMap targets(data + num_scales + centres.size(), num_centres_, outputs);

  GpModel network;
  network.inputs = centres.transpose();
  const ConstMap log_length_scales(data, input_dim_, outputs);
  network.hyperparameters.setZero(input_dim_ + 2, outputs);  // the signal's std is 1
  network.hyperparameters.topRows(input_dim_) = log_length_scales;
  network.hyperparameters.row(input_dim_ + 1).setConstant(0.5 * std::log(kNoiseVariance));
  network.beta.resize(num_centres_, outputs);
  kernels_.resize(outputs);
  factorisations_.resize(outputs);
  const Eigen::MatrixXd scales = log_length_scales.array().exp();
  for (int a = 0; a < outputs; ++a) {
    kernels_[a] = squaredExponential(network.inputs, network.inputs, scales.col(a), 1.0);
    Eigen::MatrixXd A = kernels_[a];
    A.diagonal().array() += kNoiseVariance;
    factorisations_[a].compute(A);
    if (factorisations_[a].info() == Eigen::Success && parameters_.allFinite()) {
      network.beta.col(a) = factorisations_[a].solve(targets.col(a));
    } else {
      network.beta.col(a).setConstant(kNaN);
    }
  }
  network_ = std::make_unique<GpMoments>(std::move(network));
}

Moments RbfPolicy::predictUnsquashed(const Gaussian& input, GpMoments::Tape* tape) const {
  Moments output = network_->predict(input, tape);
  output.covariance.diagonal().array() += kJitter;
  return output;
}

Moments RbfPolicy::predict(const Gaussian& input) const {
  const Moments unsquashed = predictUnsquashed(input);
  Moments output = squash(marginal(unsquashed), max_control_);
  output.gain = unsquashed.gain * output.gain;
  return output;
}

Gaussian RbfPolicy::backward(const Gaussian& input, const Moments& d_output,
                             Eigen::VectorXd* d_parameters) const {
  eigen_assert(d_parameters->size() == parameters_.size());
  GpMoments::Tape tape;
  const Moments unsquashed = predictUnsquashed(input, &tape);
  const Gaussian x = marginal(unsquashed);
  const Eigen::MatrixXd slopes = squash(x, max_control_).gain;
  const Gaussian d_x = squashBackward(
      x, max_control_,
      {d_output.mean, d_output.covariance, unsquashed.gain.transpose() * d_output.gain});
  GpGradient d_network{Eigen::MatrixXd::Zero(input_dim_, num_centres_),
                       Eigen::MatrixXd::Zero(num_centres_, outputDim()),
                       Eigen::MatrixXd::Zero(input_dim_, outputDim())};
  const Gaussian d_input =
      network_->backward(tape, {d_x.mean, d_x.covariance, d_output.gain * slopes}, &d_network);
  const Eigen::MatrixXd d_targets = throughBeta(&d_network);
  *d_parameters += packParameters(d_network.log_length_scales, d_network.inputs, d_targets);
  return d_input;
}

/// Adds the derivatives through beta = A^-1 t with A = K + 1e-4 I: dJ/dt = A^-1 dJ/dbeta and
/// dJ/dA = -(dJ/dt) beta^T. With H_ij = [dJ/dA]_ij K_ij:
///
///   dJ/dlog l_d = sum_ij H_ij (c_id - c_jd)^2 / l_d^2
///   dJ/dc_i     = -sum_j (H_ij + H_ji) Lambda^-1 (c_i - c_j)
///
/// @return dJ/dt                                                          [nc x U]
Eigen::MatrixXd RbfPolicy::throughBeta(GpGradient* d_network) const {
  const GpModel& network = network_->model();
  Eigen::MatrixXd d_targets(num_centres_, outputDim());
  for (int a = 0; a < outputDim(); ++a) {
    d_targets.col(a) = factorisations_[a].solve(d_network->beta.col(a));
    const Eigen::MatrixXd H =
        -(d_targets.col(a) * network.beta.col(a).transpose()).cwiseProduct(kernels_[a]);
    const Eigen::MatrixXd both = H + H.transpose();
    const Eigen::VectorXd sums = both.rowwise().sum();
    const Eigen::VectorXd precisions =
        (-2.0 * network.hyperparameters.col(a).head(input_dim_).array()).exp();
    // Sums of (c_i - c_j)^2 and of c_i - c_j over all pairs. The centres are columns.
    const Eigen::MatrixXd differences = network.inputs * sums.asDiagonal() - network.inputs * both;
    d_network->inputs -= precisions.asDiagonal() * differences;
    d_network->log_length_scales.col(a) +=
        precisions.cwiseProduct(network.inputs.cwiseProduct(differences).rowwise().sum());
  }
  return d_targets;
}

Eigen::VectorXd RbfPolicy::control(const Eigen::VectorXd& features) const {
  // The bounds remove rounding errors at the flat tops.
  return predict(known(features)).mean.cwiseMin(max_control_).cwiseMax(-max_control_);
}

}  // namespace ddm::pilco
