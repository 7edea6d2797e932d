// Features of a state that contains angles, and the saturating cost of a state.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/state_cost.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

namespace ddm::pilco {
namespace {

/// exp(-v) (exp(c) - 1), accurate for small c and finite even if exp(c) overflows.
double scaledGrowth(double v, double c) {
  return std::abs(c) < 1.0 ? std::exp(-v) * std::expm1(c) : std::exp(c - v) - std::exp(-v);
}

constexpr double kHalfPi = 1.57079632679489661923;

constexpr double kRounding = 1e-12;

/// E[exp(-k/2 (x - z)^T W (x - z))], and P_k = W (I + k s W)^-1.
double expectedReward(const Gaussian& input, const Eigen::VectorXd& target,
                      const Eigen::MatrixXd& weight, double k, Eigen::MatrixXd* precision) {
  const Eigen::Index dim = target.size();
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(Eigen::MatrixXd::Identity(dim, dim) +
                                                k * weight * s);
  *precision = symmetricPart(lu.solve(weight));
  const Eigen::VectorXd d = input.mean - target;
  return std::exp(-0.5 * k * d.dot(*precision * d)) / std::sqrt(lu.determinant());
}

}  // namespace

double sineCovariance(double mean_a, double mean_b, double variance_a, double variance_b,
                      double covariance, SineCovarianceGradient* gradient) {
  const double half_sum = 0.5 * (variance_a + variance_b);
  const double p = scaledGrowth(half_sum, covariance);
  const double r = scaledGrowth(half_sum, -covariance);
  const double difference = mean_a - mean_b;
  const double sum = mean_a + mean_b;
  const double value = 0.5 * (p * std::cos(difference) - r * std::cos(sum));
  if (gradient != nullptr) {
    gradient->mean_a = 0.5 * (-p * std::sin(difference) + r * std::sin(sum));
    gradient->mean_b = 0.5 * (p * std::sin(difference) + r * std::sin(sum));
    gradient->variance = -0.5 * value;
    gradient->covariance = 0.5 * (std::exp(covariance - half_sum) * std::cos(difference) +
                                  std::exp(-covariance - half_sum) * std::cos(sum));
  }
  return value;
}

Augmentation::Augmentation(int input_dim, std::vector<int> kept, std::vector<int> angles)
    : input_dim_(input_dim), kept_(std::move(kept)), angles_(std::move(angles)) {}

int Augmentation::outputDim() const { return static_cast<int>(kept_.size() + 2 * angles_.size()); }

Eigen::VectorXd Augmentation::value(const Eigen::VectorXd& x) const {
  return predict(known(x)).mean;
}

Moments Augmentation::predict(const Gaussian& input) const {
  const Eigen::VectorXd& m = input.mean;
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  Moments output = constantMoments(input_dim_, outputDim());
  const int num_kept = static_cast<int>(kept_.size());
  for (int k = 0; k < num_kept; ++k) {
    output.mean[k] = m[kept_[k]];
    output.gain(kept_[k], k) = 1.0;
  }
  for (std::size_t k = 0; k < angles_.size(); ++k) {
    const int i = angles_[k];
    const int sine = num_kept + 2 * static_cast<int>(k);
    const double scale = std::exp(-0.5 * s(i, i));
    output.mean[sine] = scale * std::sin(m[i]);
    output.mean[sine + 1] = scale * std::cos(m[i]);
    output.gain(i, sine) = output.mean[sine + 1];
    output.gain(i, sine + 1) = -output.mean[sine];
  }
  // cov(x, y) = s gain is exact and therefore contains the rows of the kept entries.
  const Eigen::MatrixXd with_input = s * output.gain;
  for (int k = 0; k < num_kept; ++k) {
    output.covariance.row(k) = with_input.row(kept_[k]);
    output.covariance.col(k) = with_input.row(kept_[k]).transpose();
  }
  for (int p = num_kept; p < outputDim(); ++p) {
    for (int q = num_kept; q <= p; ++q) {
      const int i = angles_[(p - num_kept) / 2];
      const int j = angles_[(q - num_kept) / 2];
      const double mean_p = m[i] + ((p - num_kept) % 2) * kHalfPi;
      const double mean_q = m[j] + ((q - num_kept) % 2) * kHalfPi;
      output.covariance(p, q) = sineCovariance(mean_p, mean_q, s(i, i), s(j, j), s(i, j));
      output.covariance(q, p) = output.covariance(p, q);
    }
  }
  return output;
}

Gaussian Augmentation::backward(const Gaussian& input, const Moments& d_output) const {
  const Eigen::VectorXd& m = input.mean;
  const Eigen::MatrixXd s = symmetricPart(input.covariance);
  const Moments output = predict(input);
  const Eigen::MatrixXd d_covariance = symmetricPart(d_output.covariance);
  const int num_kept = static_cast<int>(kept_.size());
  Gaussian d_input = constantGaussian(input_dim_);

  // The rows and columns of the kept entries are rows of s gain.
  Eigen::MatrixXd d_with_input = Eigen::MatrixXd::Zero(input_dim_, outputDim());
  for (int k = 0; k < num_kept; ++k) {
    d_input.mean[kept_[k]] += d_output.mean[k];
    d_with_input.row(kept_[k]).head(num_kept) += d_covariance.row(k).head(num_kept);
    d_with_input.row(kept_[k]).tail(outputDim() - num_kept) +=
        2.0 * d_covariance.row(k).tail(outputDim() - num_kept);
  }
  d_input.covariance = d_with_input * output.gain.transpose();
  const Eigen::MatrixXd d_gain = d_output.gain + s * d_with_input;

  for (std::size_t k = 0; k < angles_.size(); ++k) {
    const int i = angles_[k];
    const int sine = num_kept + 2 * static_cast<int>(k);
    const double mean_sine = output.mean[sine];
    const double mean_cosine = output.mean[sine + 1];
    const double d_sine = d_output.mean[sine] - d_gain(i, sine + 1);
    const double d_cosine = d_output.mean[sine + 1] + d_gain(i, sine);
    d_input.mean[i] += d_sine * mean_cosine - d_cosine * mean_sine;
    d_input.covariance(i, i) -= 0.5 * (d_sine * mean_sine + d_cosine * mean_cosine);
  }
  for (int p = num_kept; p < outputDim(); ++p) {
    for (int q = num_kept; q <= p; ++q) {
      const int i = angles_[(p - num_kept) / 2];
      const int j = angles_[(q - num_kept) / 2];
      const double mean_p = m[i] + ((p - num_kept) % 2) * kHalfPi;
      const double mean_q = m[j] + ((q - num_kept) % 2) * kHalfPi;
      SineCovarianceGradient gradient;
      sineCovariance(mean_p, mean_q, s(i, i), s(j, j), s(i, j), &gradient);
      const double weight = (p == q ? 1.0 : 2.0) * d_covariance(p, q);
      d_input.mean[i] += weight * gradient.mean_a;
      d_input.mean[j] += weight * gradient.mean_b;
      d_input.covariance(i, i) += weight * gradient.variance;
      d_input.covariance(j, j) += weight * gradient.variance;
      d_input.covariance(i, j) += weight * gradient.covariance;
    }
  }
  d_input.covariance = symmetricPart(d_input.covariance);
  return d_input;
}

Augmentation replaceAngles(int input_dim, const std::vector<int>& angles) {
  std::vector<int> kept;
  for (int i = 0; i < input_dim; ++i) {
    if (std::find(angles.begin(), angles.end(), i) == angles.end()) kept.push_back(i);
  }
  return Augmentation(input_dim, kept, angles);
}

StateCost::StateCost(Augmentation features, Eigen::VectorXd target, const Eigen::MatrixXd& weight)
    : features_(std::move(features)), target_(std::move(target)), weight_(weight) {
  eigen_assert(features_.outputDim() == target_.size() &&
               weight_.isApprox(weight_.transpose(), kRounding));
}

/// dE[c]/dm = r P d,  dE[c]/ds = r (P - P d d^T P) / 2,  with r = 1 - E[c], d = m - z.
double StateCost::expected(const Gaussian& state, Gaussian* d_state) const {
  const Gaussian features = marginal(features_.predict(state));
  Eigen::MatrixXd P;
  const double reward = expectedReward(features, target_, weight_, 1.0, &P);
  if (d_state != nullptr) {
    const Eigen::VectorXd P_d = P * (features.mean - target_);
    *d_state = features_.backward(
        state, Moments{reward * P_d, 0.5 * reward * (P - P_d * P_d.transpose()),
                       Eigen::MatrixXd::Zero(features_.inputDim(), features_.outputDim())});
  }
  return 1.0 - reward;
}

double StateCost::variance(const Gaussian& state) const {
  const Gaussian features = marginal(features_.predict(state));
  Eigen::MatrixXd P;
  const double reward = expectedReward(features, target_, weight_, 1.0, &P);
  const double squared = expectedReward(features, target_, weight_, 2.0, &P);
  const double variance = squared - reward * reward;
  return variance >= kRounding ? variance : 0.0;
}

StateCost pendulumCost(double length, double width) {
  const double weight = length * length / (width * width);
  return StateCost(Augmentation(2, {}, {1}), Eigen::Vector2d(0.0, -1.0),
                   weight * Eigen::MatrixXd::Identity(2, 2));
}

}  // namespace ddm::pilco
