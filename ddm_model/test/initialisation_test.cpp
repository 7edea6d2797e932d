// Tests of the initial parameters: layer-wise PCA of the auto-encoder, random predictor.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "ddm_model/networks.h"
#include "ddm_model/pca.h"
#include "toy_data.h"

namespace ddm {
namespace {

class Initialisation : public ::testing::Test {
 protected:
  Eigen::VectorXd initial(const ModelOptions& options, unsigned seed = 1) const {
    std::mt19937_64 rng(seed);
    return initialTheta(Networks<double>(options, 1), scores_, pca_start_, &rng);
  }

  const DataSet data_ = testing::toyTrial(80, 1);
  const Eigen::MatrixXd scores_ = fitPca(data_, 6).project(data_).cast<double>();
  bool pca_start_ = true;
};

TEST_F(Initialisation, MirroredLayersFormAProjectionOntoPrincipalComponents) {
  const ModelOptions options = testing::toyModelOptions();  // 6-5-2-5-6
  const Networks<double> nets(options, 1);
  const Eigen::VectorXd theta = initial(options);
  Eigen::MatrixXd inputs = scores_;
  for (int layer = 0; layer < 2; ++layer) {
    const Eigen::MatrixXd encoder_w = nets.encoder().weights(theta.data(), layer);
    const Eigen::VectorXd encoder_b = nets.encoder().biases(theta.data(), layer);
    const Eigen::MatrixXd decoder_w =
        nets.decoder().weights(nets.decoderOf(theta.data()), 1 - layer);
    const Eigen::VectorXd decoder_b =
        nets.decoder().biases(nets.decoderOf(theta.data()), 1 - layer);
    const Eigen::VectorXd mean = inputs.rowwise().mean();
    const Eigen::MatrixXd centred = inputs.colwise() - mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(centred * centred.transpose());
    const Eigen::MatrixXd basis = eigen.eigenvectors().rightCols(encoder_w.rows());
    EXPECT_TRUE((decoder_w * encoder_w).isApprox(basis * basis.transpose(), 1e-6)) << layer;
    EXPECT_TRUE(decoder_b.isApprox(mean, 1e-9) || mean.norm() < 1e-4) << layer;
    EXPECT_LT((encoder_w * mean + encoder_b).norm(), 1e-9) << layer;
    const Eigen::MatrixXd before_arctan = (encoder_w * inputs).colwise() + encoder_b;
    const double spread = std::sqrt(before_arctan.row(0).array().square().mean());
    EXPECT_NEAR(spread, 0.3, 1e-6) << layer;
    inputs = before_arctan.array().atan();
  }
}

TEST_F(Initialisation, DrawsOnlyThePredictorFromTheStream) {
  const ModelOptions options = testing::toyModelOptions();
  const Networks<double> nets(options, 1);
  const Eigen::VectorXd a = initial(options, 1), again = initial(options, 1);
  const Eigen::VectorXd b = initial(options, 2);
  EXPECT_EQ(a, again);
  const Eigen::Index num_ae = a.size() - nets.f().numParams();
  EXPECT_EQ(a.head(num_ae), b.head(num_ae));
  EXPECT_NE(a.tail(nets.f().numParams()), b.tail(nets.f().numParams()));
}

TEST_F(Initialisation, UnitsBeyondTheRankOfTheInputStartAtRandom) {
  ModelOptions options = testing::toyModelOptions();
  options.encoder_widths = {9};  // more than the 6 scores
  const Networks<double> nets(options, 1);
  const Eigen::VectorXd theta = initial(options);
  EXPECT_TRUE(theta.allFinite());
  const Eigen::MatrixXd w = nets.encoder().weights(theta.data(), 0);
  EXPECT_GT(w.bottomRows(3).rowwise().squaredNorm().minCoeff(), 0.0);
  EXPECT_NE(w.bottomRows(3), nets.encoder().weights(initial(options, 2).data(), 0).bottomRows(3));
}

TEST_F(Initialisation, ARandomStartLeavesThePcaOutAndThePredictorAsItIs) {
  const ModelOptions options = testing::toyModelOptions();
  const Networks<double> nets(options, 1);
  const Eigen::VectorXd from_pca = initial(options, 1);
  pca_start_ = false;
  const Eigen::VectorXd a = initial(options, 1), b = initial(options, 2);
  EXPECT_NE(a.head(30), b.head(30));  // the encoder's first weights
  EXPECT_EQ(nets.encoder().biases(a.data(), 0).norm(), 0.0);
  EXPECT_EQ(a.tail(nets.f().numParams()), from_pca.tail(nets.f().numParams()));
}

TEST_F(Initialisation, JoinedAutoEncodersGiveAllFeaturesAndTheMeanOfTheirImages) {
  const ModelOptions one = testing::toyModelOptions();
  const std::vector<Eigen::VectorXd> thetas = {initial(one, 1), initial(one, 2), initial(one, 3)};
  const Networks<double> part(one, 1), all(joinedOptions(one, 3), 1);
  pca_start_ = false;
  const std::vector<Eigen::VectorXd> others = {initial(one, 4), initial(one, 5), initial(one, 6)};
  for (const auto& models : {thetas, others}) {
    const Eigen::VectorXd theta = joinAutoEncoders(one, models);
    Mlp<double>::Tape z, image, joined_z, joined_image;
    all.encoder().forward(all.encoderOf(theta.data()), scores_, &joined_z);
    all.decoder().forward(all.decoderOf(theta.data()), joined_z.output(), &joined_image);
    Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(scores_.rows(), scores_.cols());
    for (int i = 0; i < 3; ++i) {
      const double* own = models[static_cast<size_t>(i)].data();
      part.encoder().forward(part.encoderOf(own), scores_, &z);
      part.decoder().forward(part.decoderOf(own), z.output(), &image);
      EXPECT_TRUE(joined_z.output().middleRows(2 * i, 2).isApprox(z.output(), 1e-12)) << i;
      mean += image.output() / 3.0;
    }
    EXPECT_TRUE(joined_image.output().isApprox(mean, 1e-12));
  }
}

}  // namespace
}  // namespace ddm
