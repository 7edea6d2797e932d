// Gaussian blur of square images, as a linear map of their pixels.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/blur.h"

#include <cmath>

namespace ddm {

Blur::Blur(int image_size, double std) {
  if (!(std > 0.0)) return;
  G_ = Eigen::MatrixXf::NullaryExpr(image_size, image_size, [std](Eigen::Index i, Eigen::Index j) {
    const double distance = static_cast<double>(i - j) / std;
    return static_cast<float>(std::exp(-0.5 * distance * distance));
  });
  G_.array().colwise() /= G_.rowwise().sum().array().eval();
}

}  // namespace ddm
