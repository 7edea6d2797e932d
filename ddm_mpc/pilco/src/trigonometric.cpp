// Moments of sines and cosines of Gaussian angles, and features of a state with angles.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/trigonometric.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ddm_pilco/messages.h"

namespace ddm::pilco {
namespace {

/// exp(-v) (exp(c) - 1): exact for small c, and finite where exp(c) alone is not.
double scaledGrowth(double v, double c) {
  return std::abs(c) < 1.0 ? std::exp(-v) * std::expm1(c) : std::exp(c - v) - std::exp(-v);
}

constexpr double kHalfPi = 1.57079632679489661923;

void requireIndices(const std::vector<int>& indices, int dim) {
  for (const int index : indices) {
    require(index >= 0 && index < dim, "augmentation: an index must lie in 0 ... ", dim - 1,
            ", got ", index);
  }
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

Augmentation::Augmentation(int input_dim, std::vector<int> kept, std::vector<int> angles,
                           std::vector<double> scales)
    : input_dim_(input_dim),
      kept_(std::move(kept)),
      angles_(std::move(angles)),
      scales_(std::move(scales)) {
  requireIndices(kept_, input_dim);
  requireIndices(angles_, input_dim);
  if (scales_.empty()) scales_.assign(angles_.size(), 1.0);
  require(scales_.size() == angles_.size(),
          "augmentation: there must be as many scales as angles, got ", scales_.size(), " and ",
          angles_.size());
  require(outputDim() >= 1, "augmentation: there must be an output");
}

int Augmentation::outputDim() const { return static_cast<int>(kept_.size() + 2 * angles_.size()); }

Eigen::VectorXd Augmentation::value(const Eigen::VectorXd& x) const {
  return predict(known(x)).mean;
}

Moments Augmentation::predict(const Gaussian& input) const {
  requireSize(input, input_dim_, "augmentation");
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
    const double scale = scales_[k] * std::exp(-0.5 * s(i, i));
    output.mean[sine] = scale * std::sin(m[i]);
    output.mean[sine + 1] = scale * std::cos(m[i]);
    output.gain(i, sine) = output.mean[sine + 1];
    output.gain(i, sine + 1) = -output.mean[sine];
  }
  // cov(x, y) = s gain is exact, so it also holds the rows of the kept entries.
  const Eigen::MatrixXd with_input = s * output.gain;
  for (int k = 0; k < num_kept; ++k) {
    output.covariance.row(k) = with_input.row(kept_[k]);
    output.covariance.col(k) = with_input.row(kept_[k]).transpose();
  }
  for (int p = num_kept; p < outputDim(); ++p) {
    for (int q = num_kept; q <= p; ++q) {
      const int a = (p - num_kept) / 2;
      const int b = (q - num_kept) / 2;
      const int i = angles_[a];
      const int j = angles_[b];
      const double mean_p = m[i] + ((p - num_kept) % 2) * kHalfPi;
      const double mean_q = m[j] + ((q - num_kept) % 2) * kHalfPi;
      output.covariance(p, q) =
          scales_[a] * scales_[b] * sineCovariance(mean_p, mean_q, s(i, i), s(j, j), s(i, j));
      output.covariance(q, p) = output.covariance(p, q);
    }
  }
  return output;
}

Gaussian Augmentation::backward(const Gaussian& input, const Moments& d_output) const {
  requireSize(input, input_dim_, "augmentation");
  requireSize(d_output, input_dim_, outputDim(), "augmentation");
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
      const int a = (p - num_kept) / 2;
      const int b = (q - num_kept) / 2;
      const int i = angles_[a];
      const int j = angles_[b];
      const double mean_p = m[i] + ((p - num_kept) % 2) * kHalfPi;
      const double mean_q = m[j] + ((q - num_kept) % 2) * kHalfPi;
      SineCovarianceGradient gradient;
      sineCovariance(mean_p, mean_q, s(i, i), s(j, j), s(i, j), &gradient);
      const double weight = (p == q ? 1.0 : 2.0) * d_covariance(p, q) * scales_[a] * scales_[b];
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

}  // namespace ddm::pilco
