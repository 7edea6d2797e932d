// Tests of the blur: that it is a Gaussian, and that its transposed map is that.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/blur.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ddm_model/testing/random_matrix.h"

namespace ddm {
namespace {

constexpr int kSize = 21;
constexpr double kStd = 1.5;

Eigen::MatrixXf randomImages() { return testing::randomMatrix(kSize * kSize, 3, 1).cast<float>(); }

TEST(Blur, SpreadsAPointAsAGaussian) {
  Eigen::MatrixXf images = Eigen::MatrixXf::Zero(kSize * kSize, 1);
  const auto at = [](int row, int col) { return row * kSize + col; };
  images(at(10, 10), 0) = 1.0F;
  Blur(kSize, kStd).apply(&images);
  EXPECT_NEAR(images.sum(), 1.0F, 1e-4F);
  for (int distance = 1; distance < 5; ++distance) {
    const double share = std::exp(-0.5 * distance * distance / (kStd * kStd));
    EXPECT_NEAR(images(at(10, 10 + distance), 0) / images(at(10, 10), 0), share, 1e-4);
    EXPECT_NEAR(images(at(10 - distance, 10), 0) / images(at(10, 10), 0), share, 1e-4);
  }
}

TEST(Blur, LeavesAGreyWallAsItIsUpToItsEdges) {
  Eigen::MatrixXf images = Eigen::MatrixXf::Constant(kSize * kSize, 2, 0.75F);
  Blur(kSize, kStd).apply(&images);
  EXPECT_LT((images.array() - 0.75F).abs().maxCoeff(), 1e-5F);
}

TEST(Blur, OfNoWidthChangesNothing) {
  Eigen::MatrixXf images = randomImages();
  Blur(kSize, 0.0).apply(&images);
  EXPECT_EQ(images, randomImages());
  Blur().applyTransposed(&images);
  EXPECT_EQ(images, randomImages());
}

TEST(Blur, HasTheTransposedMap) {
  const Blur blur(kSize, kStd);
  Eigen::MatrixXf blurred = randomImages(), transposed = blurred;
  blur.apply(&blurred);
  blur.applyTransposed(&transposed);
  EXPECT_NEAR(blurred.col(0).dot(randomImages().col(1)),
              randomImages().col(0).dot(transposed.col(1)), 1e-3F);
}

}  // namespace
}  // namespace ddm
