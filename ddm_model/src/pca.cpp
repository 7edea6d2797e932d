// Principal component analysis, which turns images into scores for the encoder and back.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/pca.h"

#include <ddm_common/option_checks.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace ddm {
namespace {

constexpr int kOversampling = 10;
constexpr int kMaxSweeps = 30;
constexpr double kVarianceTolerance = 1e-5;
constexpr Eigen::Index kBlock = 256;  // images that are converted to float at a time
constexpr float kWhite = 255.0F;
constexpr double kMaxGain = 4.0;  // the noise of a dark image must not look like the plant

using Bytes = Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>>;

/// @return root mean square of an image [grey]
template <class Pixels>
double brightnessOf(const Pixels& pixels) {
  const double mean = pixels.template cast<double>().squaredNorm() / pixels.size();
  return std::sqrt(mean) / kWhite;
}

/// @param brightness  root mean square that the image gets [grey]; 0: it does not change
/// @return            factor by which its grey values are multiplied
template <class Pixels>
double gainOf(const Pixels& pixels, float brightness) {
  if (brightness == 0.0F) return 1.0;
  return std::min(kMaxGain, brightness / brightnessOf(pixels));
}

Eigen::MatrixXf orthonormalised(const Eigen::MatrixXf& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXf> qr(columns);
  return qr.householderQ() * Eigen::MatrixXf::Identity(columns.rows(), columns.cols());
}

/// The matrix K [D x M] of all images of a data set, the goal image last: grey values times their
/// gain minus the mean, blurred. K is never stored; blocks of its columns are computed when needed. The blur is
/// linear, and is applied to the few columns that K is multiplied with.
class CentredImages {
 public:
  CentredImages(const DataSet& data, const Blur& blur, bool normalise_brightness)
      : data_(data), blur_(blur) {
    const auto num_images = static_cast<double>(data.numImages());
    if (normalise_brightness) {
      double sum = 0.0;
      for (Eigen::Index i = 0; i < data.numImages(); ++i) sum += brightnessOf(bytes(i));
      brightness_ = static_cast<float>(sum / num_images);
    }
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(data.numPixels());
    for (Eigen::Index i = 0; i < data.numImages(); ++i) {
      sum += gainOf(bytes(i), brightness_) * bytes(i).cast<double>();
    }
    mean_ = (sum / num_images).cast<float>();
  }

  /// @return mean of the images' root mean squares [grey]; 0: all gains are 1
  float brightness() const { return brightness_; }

  /// @return mean of the blurred images  [D]
  Eigen::VectorXf mean() const {
    Eigen::MatrixXf mean = mean_;
    blur_.apply(&mean);
    return mean;
  }

  /// @param columns  [D x k]
  /// @return         K K^T columns / M  [D x k]
  Eigen::MatrixXf covarianceTimes(Eigen::MatrixXf columns) const {
    blur_.applyTransposed(&columns);
    Eigen::MatrixXf product = Eigen::MatrixXf::Zero(data_.numPixels(), columns.cols());
    Eigen::MatrixXf block(data_.numPixels(), std::min(kBlock, data_.numImages()));
    Eigen::MatrixXf scores(block.cols(), columns.cols());
    for (Eigen::Index begin = 0; begin < data_.numImages(); begin += kBlock) {
      const Eigen::Index size = std::min(kBlock, data_.numImages() - begin);
      for (Eigen::Index i = 0; i < size; ++i) {
        const Bytes pixels = bytes(begin + i);
        const auto gain = static_cast<float>(gainOf(pixels, brightness_));
        block.col(i) = gain * pixels.cast<float>() - mean_;
      }
      scores.topRows(size).noalias() = block.leftCols(size).transpose() * columns;
      product.noalias() += block.leftCols(size) * scores.topRows(size);
    }
    blur_.apply(&product);
    return product / static_cast<float>(data_.numImages());
  }

 private:
  Bytes bytes(Eigen::Index i) const { return {data_.image(i).data(), data_.numPixels()}; }

  const DataSet& data_;
  const Blur& blur_;
  float brightness_ = 0.0F;
  Eigen::VectorXf mean_;  // of the images before the blur
};

}  // namespace

Blur::Blur(int image_size, double std) {
  if (!(std > 0.0)) return;
  Eigen::MatrixXd G(image_size, image_size);
  for (Eigen::Index i = 0; i < image_size; ++i) {
    for (Eigen::Index j = 0; j < image_size; ++j) {
      const double distance = static_cast<double>(i - j) / std;
      G(i, j) = std::exp(-0.5 * distance * distance);
    }
    G.row(i) /= G.row(i).sum();
  }
  G_ = G.cast<float>();  // converted last, so that the weights equal those that NumPy computes
}

Eigen::MatrixXf Pca::project(const DataSet& data) const {
  Eigen::MatrixXf scores(basis.cols(), data.numImages());
  for (Eigen::Index begin = 0; begin < data.numImages(); begin += kBlock) {
    const ImageMatrix pixels = data.pixels(begin, std::min(kBlock, data.numImages() - begin));
    Eigen::MatrixXf images = pixels.cast<float>() / kWhite;
    for (Eigen::Index i = 0; i < images.cols(); ++i) {
      images.col(i) *= static_cast<float>(gainOf(pixels.col(i), brightness));
    }
    blur.apply(&images);
    const Eigen::MatrixXf of_block = scale * (basis.transpose() * (images.colwise() - mean));
    scores.middleCols(begin, images.cols()) = of_block;
  }
  return scores;
}

Eigen::MatrixXf Pca::reconstruct(const Eigen::Ref<const Eigen::MatrixXf>& scores) const {
  return (basis * (scores / scale)).colwise() + mean;
}

Projection::Projection(const Pca& pca) : brightness_(pca.brightness) {
  Eigen::MatrixXd filters = pca.basis.cast<double>();
  offset_ = pca.scale * (filters.transpose() * pca.mean.cast<double>());
  pca.blur.applyTransposed(&filters);
  filters_ = static_cast<double>(pca.scale) / kWhite * filters.transpose();
}

Eigen::VectorXd Projection::operator()(const Image& image) const {
  const Bytes pixels(image.data(), static_cast<Eigen::Index>(image.size()));
  return gainOf(pixels, brightness_) * (filters_ * pixels.cast<double>()) - offset_;
}

Pca fitPca(const DataSet& data, int dim, const Blur& blur, bool normalise_brightness,
           const std::function<void()>& check) {
  const Eigen::Index num_images = data.numImages();
  if (data.numPixels() < dim) {
    throw std::invalid_argument(textOf("PCA to model/pca_dim = ", dim, " of images of ",
                                       data.numPixels(), " pixels: lower model/pca_dim"));
  }
  if (num_images < dim + 1) {
    throw std::invalid_argument(textOf("PCA to model/pca_dim = ", dim, " needs at least ", dim + 1,
                                       " images, got ", num_images,
                                       ": record more frames or lower model/pca_dim"));
  }
  const CentredImages images(data, blur, normalise_brightness);
  Pca pca;
  pca.brightness = images.brightness();
  pca.blur = blur;
  pca.mean = images.mean() / kWhite;

  const Eigen::Index subspace = std::min<Eigen::Index>(
      {static_cast<Eigen::Index>(dim) + kOversampling, num_images, data.numPixels()});
  std::mt19937_64 rng(1);  // the result does not depend on the seed
  std::normal_distribution<float> normal;
  Eigen::MatrixXf next(data.numPixels(), subspace);
  for (Eigen::Index i = 0; i < next.size(); ++i) next.data()[i] = normal(rng);

  Eigen::MatrixXf basis;  // orthonormal columns; `ritz` decomposes the covariance in this basis
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  double captured = 0.0;  // variance along the first `dim` directions of the subspace
  bool settled = false;
  for (int sweep = 0; sweep < kMaxSweeps && !settled; ++sweep) {
    if (check) check();
    basis = orthonormalised(next);
    next = images.covarianceTimes(basis);
    ritz.compute(basis.cast<double>().transpose() * next.cast<double>());
    const double captured_now = ritz.eigenvalues().tail(dim).sum();
    settled = std::abs(captured_now - captured) <= kVarianceTolerance * captured_now;
    captured = captured_now;
  }
  pca.basis = basis * ritz.eigenvectors().rightCols(dim).rowwise().reverse().cast<float>();
  pca.variance = ritz.eigenvalues().tail(dim).reverse().cwiseMax(0.0) / (kWhite * kWhite);
  if (!(pca.variance[0] > 1e-12)) {
    throw std::invalid_argument(
        textOf("all ", num_images, " images are the same: there is nothing to learn from them"));
  }
  // The sign of a component is arbitrary. Fix it, so that equal data give equal models.
  for (int k = 0; k < dim; ++k) {
    Eigen::Index largest;
    pca.basis.col(k).cwiseAbs().maxCoeff(&largest);
    if (pca.basis(largest, k) < 0.0F) pca.basis.col(k) *= -1.0F;
  }
  pca.scale = static_cast<float>(1.0 / std::sqrt(pca.variance[0]));
  return pca;
}

}  // namespace ddm
