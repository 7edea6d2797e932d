// Principal component analysis, which turns images into scores for the encoder and back.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "ddm_model/data_set.h"

namespace ddm {

/// Gaussian blur Y -> G Y G^T of an image Y. Each row of G is a Gaussian about its pixel, cut off
/// at the edge of the image and normalised, so that a uniform image does not change. With blur,
/// thin parts of a large image overlap from one pose to the next, and few principal components show
/// them.
class Blur {
 public:
  template <class Scalar>
  using Images = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  Blur() = default;  ///< no blur
  /// @param image_size  width and height of the images [pixels]
  /// @param std         standard deviation of the Gaussian [pixels]; 0: images stay as they are
  Blur(int image_size, double std);

  /// @param images  one image per column  [D x N]
  template <class Scalar>
  void apply(Images<Scalar>* images) const {
    map<Scalar>(G_.cast<Scalar>(), images);
  }
  /// Applies the transposed map Y -> G^T Y G.
  /// @param images  one image per column  [D x N]
  template <class Scalar>
  void applyTransposed(Images<Scalar>* images) const {
    map<Scalar>(G_.transpose().cast<Scalar>(), images);
  }

 private:
  template <class Scalar>
  static void map(const Images<Scalar>& G, Images<Scalar>* images) {
    if (G.size() == 0) return;
    for (Eigen::Index i = 0; i < images->cols(); ++i) {
      Eigen::Map<Images<Scalar>> image(images->col(i).data(), G.rows(), G.cols());
      image = (G * image * G.transpose()).eval();
    }
  }

  Eigen::MatrixXf G_;  // empty: no blur  [image_size x image_size]
};

/// PCA: orthonormal basis of the leading principal components (paper, Sec. 4).
///
///   score = scale * basis^T (blur(gain y) - mean),      y_hat = mean + basis * score / scale
///
/// All scores have the same scale, which preserves distances between images. It gives the leading
/// score a standard deviation of 1.
///
/// Deviation: with a brightness > 0, the gain of an image gives it this root mean square. Brighter
/// or darker light, and a camera that changes its exposure, then change neither scores nor
/// features.
struct Pca {
  float brightness = 0.0F;   ///< root mean square of each image [grey]; 0: the gain is 1
  Blur blur;                 ///< blur applied to every image
  Eigen::VectorXf mean;      ///< mean of the blurred images             [D]
  Eigen::MatrixXf basis;     ///< orthonormal columns, leading one first    [D x pca_dim]
  Eigen::VectorXd variance;  ///< variance along each column [grey^2]    [pca_dim]
  float scale = 1.0F;        ///< scale of the scores [1 / grey]

  /// Projects all images of a data set, the goal image last, in blocks of a few hundred images.
  /// @return        scores [-]                     [pca_dim x data.numImages()]
  Eigen::MatrixXf project(const DataSet& data) const;

  /// @param scores  [pca_dim x N]
  /// @return        blurred images, not clamped to [0, 1]  [D x N]
  Eigen::MatrixXf reconstruct(const Eigen::Ref<const Eigen::MatrixXf>& scores) const;
};

/// PCA of one image in double precision, because the networks may magnify a rounding error a
/// hundred times. Blur, mean and basis form one affine map of the pixels after the gain.
class Projection {
 public:
  Projection() = default;  ///< invalid until a projection is assigned
  explicit Projection(const Pca& pca);

  /// @param image  grey values k [D]
  /// @return      scores [-]     [pca_dim]
  Eigen::VectorXd operator()(const Image& image) const;

 private:
  float brightness_ = 0.0F;
  Eigen::MatrixXd filters_;  ///< scale / 255 (blurred basis)^T  [pca_dim x D]
  Eigen::VectorXd offset_;   ///< scale basis^T mean             [pca_dim]
};

/// Computes the leading principal components of all images of a data set, including its goal image,
/// by subspace iteration from fixed initial vectors (Halko, Martinsson, Tropp 2011, Alg. 4.4 and
/// Sec. 4.5). The result is exact if there are at most dim + 10 images.
///
/// The iteration ends when a sweep changes the captured variance by less than 1e-5 of it, or after
/// 30 sweeps. The missed share of the variance is then below 1e-6 if few things move in the images,
/// and below 1e-3 if the images are noise.
/// @param data   at least dim + 1 images
/// @param dim    number of components
/// @param blur   blur applied to every image
/// @param normalise_brightness  whether each image gets the mean of the images' root mean squares
/// @param check  (optional) called before each sweep; may throw to end the iteration
/// @throws std::invalid_argument if there are fewer than dim pixels or too few images, or if all
///         images are equal; also every exception of check
Pca fitPca(const DataSet& data, int dim, const Blur& blur = Blur(),
           bool normalise_brightness = false, const std::function<void()>& check = nullptr);

}  // namespace ddm
