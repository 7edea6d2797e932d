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
  Blur() = default;  ///< none
  /// @param image_size  width and height of the images [pixels]
  /// @param std         standard deviation of the Gaussian [pixels]; 0: images stay as they are
  Blur(int image_size, double std);

  /// @param images  one image per column  [D x N]
  void apply(Eigen::MatrixXf* images) const { map(G_, images); }
  /// G; empty where there is no blur  [image_size x image_size]
  const Eigen::MatrixXf& matrix() const { return G_; }
  /// The transposed map.
  /// @param images  one image per column  [D x N]
  void applyTransposed(Eigen::MatrixXf* images) const { map(G_.transpose(), images); }

 private:
  void map(const Eigen::MatrixXf& G, Eigen::MatrixXf* images) const;

  Eigen::MatrixXf G_;  // empty: no blur  [image_size x image_size]
};

}  // namespace ddm
