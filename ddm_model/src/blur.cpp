// Gaussian blur of square images, as a linear map of their pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/blur.h"

#include <cmath>

namespace ddm {

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
  G_ = G.cast<float>();  // last: NumPy then has the same weights
}

}  // namespace ddm
