// Principal component analysis: images y to scores, before the encoder and after the decoder.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "ddm_model/data_set.h"

namespace ddm {

/// Y -> G Y G^T for an image Y, with the rows of G a Gaussian about their pixel, cut off at the edge
/// of the image and normalised: a grey wall stays as it is. Thin parts of a large picture then
/// share pixels from one pose to the next, and few principal components show them.
class Blur {
 public:
  template <class Scalar>
  using Images = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  Blur() = default;  ///< none
  /// @param image_size  width and height of the images [pixels]
  /// @param std         standard deviation of the Gaussian [pixels]; 0: images stay as they are
  Blur(int image_size, double std);

  /// @param images  one image per column  [D x N]
  template <class Scalar>
  void apply(Images<Scalar>* images) const {
    map<Scalar>(G_.cast<Scalar>(), images);
  }
  /// G; empty where there is no blur  [image_size x image_size]
  const Eigen::MatrixXf& matrix() const { return G_; }
  /// The transposed map.
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

/// Orthonormal basis of the leading principal components.
///
///   score = scale * basis^T (blur(y) - mean),      y_hat = mean + basis * score / scale
///
/// One common scale for all scores keeps the geometry of the pixels; the leading score has a standard
/// deviation of 1.
struct Pca {
  Blur blur;                 ///< through which images are seen
  Eigen::VectorXf mean;      ///< mean image, blurred                       [D]
  Eigen::MatrixXf basis;     ///< orthonormal columns, leading one first    [D x pca_dim]
  Eigen::VectorXd variance;  ///< variance along each column [grey^2]    [pca_dim]
  float scale = 1.0F;        ///< 1 / grey

  /// @param pixels  grey values k of N images      [D x N]
  /// @return        scores [-]                     [pca_dim x N]
  Eigen::MatrixXf project(const Eigen::Ref<const GreyMatrix>& pixels) const;

  /// The same of all images of a data set, the goal last; a few at a time are floats.
  /// @return        scores [-]                     [pca_dim x data.numImages()]
  Eigen::MatrixXf project(const DataSet& data) const;

  /// @param scores  [pca_dim x N]
  /// @return        blurred images, not clamped to [0, 1]  [D x N]
  Eigen::MatrixXf reconstruct(const Eigen::Ref<const Eigen::MatrixXf>& scores) const;
};

/// Scores of one image after another, in double: what comes after them may magnify a rounding error a hundred times.
/// Blur, mean and basis are one linear map of the pixels.
class Projection {
 public:
  Projection() = default;  ///< of no use until another is assigned
  explicit Projection(const Pca& pca);

  /// @param grey  grey values k  [D]
  /// @return      scores [-]     [pca_dim]
  Eigen::VectorXd operator()(const Grey& grey) const;

 private:
  Eigen::MatrixXd filters_;  ///< scale / 255 (blurred basis)^T  [pca_dim x D]
  Eigen::VectorXd offset_;   ///< scale basis^T mean             [pca_dim]
};

/// Leading principal components of all images of a data set, its goal image included, by subspace
/// iteration from a fixed start (Halko, Martinsson, Tropp 2011, Alg. 4.4 and Sec. 4.5). Exact where
/// there are at most as many images as the iterated subspace has dimensions.
///
/// It ends when a sweep changes the variance captured by less than 1e-5 of itself, or after 30. The
/// variance missed is then less than 1e-6 of what there is where few things move, and less than
/// 1e-3 where images are noise.
/// @param data       at least dim + 1 images
/// @param dim        number of components
/// @param blur       through which all images are seen
/// @param check      (optional) called before each sweep; may throw to end the search
/// @throws std::invalid_argument if there are too few images or they are all the same
Pca fitPca(const DataSet& data, int dim, const Blur& blur = Blur(),
           const std::function<void()>& check = nullptr);

}  // namespace ddm
