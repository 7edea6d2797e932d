// Gaussian blur of square images, as a linear map of their pixels.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

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

}  // namespace ddm
