// How much of given images a model keeps: in its principal components, and in its features.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/image_errors.h"

#include <cmath>
#include <stdexcept>

namespace ddm {
namespace {

/// The paper's y of grey values k.
Eigen::VectorXd imageOf(const Grey& grey) {
  const Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>> k(
      grey.data(), static_cast<Eigen::Index>(grey.size()));
  return k.cast<double>() / 255.0;
}

double rms(const Eigen::VectorXd& difference) {
  return std::sqrt(difference.squaredNorm() / static_cast<double>(difference.size()));
}

}  // namespace

ImageErrors imageErrors(const Ddm& model, const DataSet& data,
                        const std::function<void(double)>& progress) {
  const Eigen::Index n = data.numFrames();
  if (n < 1) throw std::invalid_argument("image errors: there is no image");
  const Pca& pca = model.pca();
  const Eigen::VectorXd mean = pca.mean.cast<double>();
  ImageErrors errors;
  for (Eigen::VectorXd* of_frames : {&errors.mean, &errors.pca, &errors.reconstruction}) {
    of_frames->resize(n);
  }
  errors.component_share = Eigen::VectorXd::Zero(pca.basis.cols());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(data.numPixels());
  double sum_of_squares = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd seen = model.encode(data.image(i));  // first: it checks the size
    const Eigen::VectorXd y = imageOf(data.image(i));
    const Eigen::VectorXf scores = pca.project(data.image(i));
    errors.mean[i] = rms(y - mean);
    errors.pca[i] = rms(y - pca.reconstruct(scores).cast<double>().col(0));
    errors.reconstruction[i] = rms(y - imageOf(model.decode(seen)));
    errors.component_share += (scores.cast<double>() / pca.scale).array().square().matrix();
    sum += y;
    sum_of_squares += y.squaredNorm();
    progress(static_cast<double>(i + 1) / static_cast<double>(n));
  }
  const double num_pixels = static_cast<double>(data.numPixels());
  const double whole = errors.mean.squaredNorm() * num_pixels;
  if (whole > 0.0) errors.component_share /= whole;
  const double count = static_cast<double>(n);
  const double variance = sum_of_squares / count - (sum / count).squaredNorm();
  errors.variation = std::sqrt(std::max(0.0, variance) / num_pixels);
  return errors;
}

}  // namespace ddm
