// Tests of the principal component analysis against an exact singular value decomposition.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/pca.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "ddm_msgs/testing/expect_error.h"
#include "toy_data.h"

namespace ddm {
namespace {

using testing::throwsNaming;

/// Images of noise: no component stands out, the hardest case for an iteration.
DataSet noise(int num_frames, int size, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_int_distribution<int> grey(0, 255);
  DataSet data(size, 1);
  for (int t = 0; t < num_frames; ++t) {
    Image image(static_cast<size_t>(size) * size);
    for (std::uint8_t& k : image) k = static_cast<std::uint8_t>(grey(rng));
    data.append(image, Eigen::VectorXd::Zero(1), false);
  }
  return data;
}

/// Two blobs on one circle, each anywhere: their variance falls slowly with the components.
DataSet twoBlobs(int num_frames, int size, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> angle(-3.14, 3.14);
  DataSet data(size, 1);
  for (int t = 0; t < num_frames; ++t) {
    Image image = testing::toyImage(angle(rng), size);
    const Image other = testing::toyImage(angle(rng), size);
    for (size_t i = 0; i < image.size(); ++i) image[i] = std::max(image[i], other[i]);
    data.append(image, Eigen::VectorXd::Zero(1), false);
  }
  return data;
}

/// All images with the goal last, minus their mean, in grey values.  [D x M]
Eigen::MatrixXd centredImages(const DataSet& data) {
  const Eigen::MatrixXd images = data.pixels(0, data.numImages()).cast<double>() / 255.0;
  return images.colwise() - Eigen::VectorXd(images.rowwise().mean());
}

struct Exact {
  Eigen::MatrixXd basis;
  Eigen::VectorXd variance;
};

Exact exactPca(const DataSet& data, int dim) {
  const Eigen::MatrixXd images = centredImages(data);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(images, Eigen::ComputeThinU);
  return {svd.matrixU().leftCols(dim),
          svd.singularValues().head(dim).array().square() / static_cast<double>(images.cols())};
}

/// Cosine of the largest angle between two subspaces of the same dimension.
double smallestCosine(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a.transpose() * b).singularValues().minCoeff();
}

TEST(Pca, FindsTheSubspaceAndVariancesOfTheExactDecomposition) {
  DataSet data = testing::toyTrial(60, 1);
  data.setGoal(testing::toyImage(3.0));
  const Pca pca = fitPca(data, 6);
  const Exact exact = exactPca(data, 6);
  EXPECT_GT(smallestCosine(pca.basis.cast<double>(), exact.basis), 1.0 - 1e-6);
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(pca.variance[k] / exact.variance[k], 1.0, 1e-4) << "component " << k;
  }
}

TEST(Pca, LacksLessThanAMillionthOfTheVarianceOfMovingThings) {
  const DataSet data = twoBlobs(250, 16, 1);
  const Pca pca = fitPca(data, 30);
  const double exact = exactPca(data, 30).variance.sum();
  EXPECT_LT(exact, 0.9999 * centredImages(data).squaredNorm() / 250.0);  // there is more
  EXPECT_NEAR(pca.variance.sum() / exact, 1.0, 1e-6);
}

/// The basis is orthonormal to the precision of a float, captures all but a thousandth of what the
/// best subspace of its dimension would, and the variances are those along its columns.
void expectNearlyBest(const DataSet& data, int dim) {
  const Pca pca = fitPca(data, dim);
  const Eigen::MatrixXd basis = pca.basis.cast<double>();
  const Eigen::MatrixXd gram = basis.transpose() * basis;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(dim, dim)).cwiseAbs().maxCoeff(), 1e-5);
  const Eigen::MatrixXd images = centredImages(data);
  const auto num_images = static_cast<double>(images.cols());
  const Eigen::MatrixXd products = images.transpose() * images / num_images;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense(products, Eigen::EigenvaluesOnly);
  const Eigen::VectorXd along = (basis.transpose() * images).rowwise().squaredNorm() / num_images;
  EXPECT_GT(along.sum() / dense.eigenvalues().tail(dim).sum(), 1.0 - 1e-3);
  EXPECT_LT((pca.variance - along).cwiseAbs().maxCoeff(), 1e-4 * along[0]);
  EXPECT_GT(pca.variance.minCoeff(), 0.0);
}

TEST(Pca, IsOrthonormalAndNearlyBestForNoiseAndFewImages) {
  for (const int num_frames : {60, 300}) expectNearlyBest(noise(num_frames, 31, 1), 50);
  for (const int dim : {1, 6, 50}) expectNearlyBest(noise(dim + 1, 21, 1), dim);
}

TEST(Pca, ItsBasisIsOrthonormalEvenIfTheImagesSpanLess) {
  DataSet few_different(testing::kToySize, 1);
  for (int t = 0; t < 20; ++t) {
    few_different.append(testing::toyImage(t % 3), Eigen::VectorXd::Zero(1), false);
  }
  for (const DataSet& data : {testing::toyTrial(60, 1), few_different}) {
    const Pca pca = fitPca(data, 6);
    const Eigen::MatrixXf gram = pca.basis.transpose() * pca.basis;
    EXPECT_LT((gram - Eigen::MatrixXf::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-5F);
    EXPECT_GE(pca.variance.minCoeff(), 0.0);
  }
}

TEST(Pca, SeesImagesThroughTheBlur) {
  const DataSet data = twoBlobs(80, 12, 3);
  const Blur blur(12, 1.5);
  Eigen::MatrixXf images = data.pixels(0, data.numImages()).cast<float>() / 255.0F;
  blur.apply(&images);
  const Eigen::VectorXf mean = images.rowwise().mean();
  const Eigen::MatrixXd centred = (images.colwise() - mean).cast<double>();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(centred, Eigen::ComputeThinU);
  const Pca pca = fitPca(data, 6, blur);
  EXPECT_LT((pca.mean - mean).cwiseAbs().maxCoeff(), 1e-5F);
  EXPECT_GT(smallestCosine(pca.basis.cast<double>(), svd.matrixU().leftCols(6)), 1.0 - 1e-5);
  const Eigen::MatrixXf scores = pca.project(data);
  EXPECT_LT((scores - pca.scale * pca.basis.transpose() * centred.cast<float>()).norm(),
            1e-4F * scores.norm());
}

TEST(Pca, GivesAllImagesTheSameBrightnessButAmplifiesADarkImageAtMostFourTimes) {
  const DataSet data = twoBlobs(80, 12, 3);
  const auto scaled = [](Image image, int divisor) {
    for (std::uint8_t& k : image) k = static_cast<std::uint8_t>(k / divisor);
    return image;
  };
  const Pca pca = fitPca(data, 6, Blur(12, 1.5), /*normalise_brightness=*/true);
  const Eigen::MatrixXd y = data.pixels(0, data.numImages()).cast<double>() / 255.0;
  EXPECT_NEAR(pca.brightness, (y.colwise().norm() / 12.0).mean(), 1e-6);  // root mean squares
  const Projection projection(pca);
  const Eigen::MatrixXf scores = pca.project(data);
  for (Eigen::Index i = 0; i < data.numFrames(); ++i) {
    const Eigen::VectorXd bright = projection(data.image(i));
    EXPECT_LT((scores.col(i).cast<double>() - bright).norm(), 1e-4 * scores.norm());
    const double half = (projection(scaled(data.image(i), 2)) - bright).norm();
    EXPECT_LT(half, 0.05);  // grey values are rounded
    const double sixteenth = (projection(scaled(data.image(i), 16)) - bright).norm();
    EXPECT_GT(sixteenth, 10.0 * half);
  }
  EXPECT_TRUE(projection(Image(144, 0)).allFinite());
}

TEST(Pca, RefusesTooFewImagesTooFewPixelsAndImagesThatAreAllTheSame) {
  const auto refuses = [](const DataSet& data, int dim, const std::vector<std::string>& parts) {
    return throwsNaming<std::invalid_argument>([&] { fitPca(data, dim); }, parts);
  };
  EXPECT_TRUE(refuses(testing::toyTrial(6, 1), 6,
                      {"model/pca_dim = 6", "at least 7 images", "got 6", "lower model/pca_dim"}));
  EXPECT_TRUE(refuses(noise(30, 4, 1), 17, {"model/pca_dim = 17", "16 pixels"}));
  DataSet same(4, 1);
  for (int t = 0; t < 10; ++t) same.append(Image(16, 77), Eigen::VectorXd::Zero(1), false);
  EXPECT_TRUE(refuses(same, 3, {"10 images", "same"}));
}

constexpr int kSize = 21;
constexpr double kStd = 1.5;

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

}  // namespace
}  // namespace ddm
