// Principal component analysis: images y to scores, before the encoder and after the decoder.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/pca.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

constexpr int kOversampling = 10;
constexpr int kMaxSweeps = 30;
constexpr double kVarianceTolerance = 1e-6;

Eigen::MatrixXf orthonormalised(const Eigen::MatrixXf& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXf> qr(columns);
  return qr.householderQ() * Eigen::MatrixXf::Identity(columns.rows(), columns.cols());
}

/// All images of the data set, the goal last, as grey values in [0, 1].  [D x M]
Eigen::MatrixXf imagesOf(const DataSet& data) {
  const Eigen::Index n = data.numFrames();
  Eigen::MatrixXf images(data.numPixels(), n + (data.hasGoal() ? 1 : 0));
  images.leftCols(n) = data.pixels().cast<float>() / 255.0F;
  if (data.hasGoal()) {
    const Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 1>> goal(data.goal().data(),
                                                                                data.numPixels());
    images.col(n) = goal.cast<float>() / 255.0F;
  }
  return images;
}

}  // namespace

Eigen::MatrixXf Pca::project(
    const Eigen::Ref<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>>& pixels)
    const {
  const Eigen::MatrixXf centred = (pixels.cast<float>() / 255.0F).colwise() - mean;
  return scale * (basis.transpose() * centred);
}

Eigen::MatrixXf Pca::reconstruct(const Eigen::Ref<const Eigen::MatrixXf>& scores) const {
  return (basis * (scores / scale)).colwise() + mean;
}

Pca fitPca(const DataSet& data, int dim, double score_std) {
  Eigen::MatrixXf images = imagesOf(data);
  const Eigen::Index num_images = images.cols();
  if (images.rows() < dim) {
    throw std::invalid_argument("PCA to model/pca_dim = " + std::to_string(dim) + " of images of " +
                                std::to_string(images.rows()) + " pixels: lower model/pca_dim");
  }
  if (num_images < dim + 1) {
    throw std::invalid_argument("PCA to model/pca_dim = " + std::to_string(dim) +
                                " needs at least " + std::to_string(dim + 1) + " images, got " +
                                std::to_string(num_images) +
                                ": record more frames or lower model/pca_dim");
  }
  Pca pca;
  pca.mean = images.rowwise().mean();
  images.colwise() -= pca.mean;

  const Eigen::Index subspace = std::min<Eigen::Index>(
      {static_cast<Eigen::Index>(dim) + kOversampling, num_images, images.rows()});
  std::mt19937_64 rng(1);  // any fixed start will do: the result does not depend on it
  std::normal_distribution<float> normal;
  Eigen::MatrixXf q(num_images, subspace);
  for (Eigen::Index i = 0; i < q.size(); ++i) q.data()[i] = normal(rng);

  Eigen::MatrixXf basis;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  double captured = -1.0;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    basis = orthonormalised(images * q);
    q.noalias() = images.transpose() * basis;
    const Eigen::MatrixXd q_double = q.cast<double>();
    ritz.compute(q_double.transpose() * q_double / static_cast<double>(num_images));
    const double captured_now = ritz.eigenvalues().tail(dim).sum();
    const bool settled = std::abs(captured_now - captured) <= kVarianceTolerance * captured_now;
    captured = captured_now;
    if (settled) break;
    q = orthonormalised(q);
  }
  pca.basis = basis * ritz.eigenvectors().rightCols(dim).rowwise().reverse().cast<float>();
  pca.variance = ritz.eigenvalues().tail(dim).reverse().cwiseMax(0.0);
  if (!(pca.variance[0] > 1e-12)) {
    throw std::invalid_argument("all " + std::to_string(num_images) +
                                " images are the same: there is nothing to learn from them");
  }
  // The sign of a component is arbitrary: fix it, so that equal data give equal models.
  for (int k = 0; k < dim; ++k) {
    Eigen::Index largest;
    pca.basis.col(k).cwiseAbs().maxCoeff(&largest);
    if (pca.basis(largest, k) < 0.0F) pca.basis.col(k) *= -1.0F;
  }
  pca.scale = static_cast<float>(score_std / std::sqrt(pca.variance[0]));
  return pca;
}

}  // namespace ddm
