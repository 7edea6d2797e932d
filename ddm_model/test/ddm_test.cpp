// Tests of a trained model: images to features and back, predictions, refusals.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_model/ddm.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "ddm_model/history.h"
#include "ddm_msgs/testing/expect_error.h"
#include "toy_data.h"

namespace ddm {
namespace {

using testing::throwsNaming;
using testing::toyImage;
using testing::toyModel;

/// The toy model with one of its parts replaced.
struct Parts {
  ModelOptions options = testing::toyModelOptions();
  int image_size = testing::kToySize;
  int torque_dim = 1;
  Pca pca = toyModel().pca();
  Eigen::VectorXd theta = toyModel().theta();
  Image goal = toyImage(1.0);

  Ddm model() const { return Ddm(options, image_size, torque_dim, pca, theta, goal, ModelInfo()); }
};

TEST(Ddm, EncodesThroughPcaAndEncoder) {
  const Ddm model = toyModel();
  const Image image = toyImage(0.5);
  const Networks<double> nets(model.options(), 1);
  Mlp<double>::Tape tape;
  nets.encoder().forward(model.theta().data(), Projection(model.pca())(image), &tape);
  ASSERT_EQ(model.encode(image).size(), 2);
  EXPECT_EQ(model.encode(image), tape.output());
}

TEST(Ddm, DecodesThroughDecoderAndPcaToTheNearestGreyValue) {
  Parts parts;
  parts.pca.mean *= 0.05F;
  parts.pca.mean.array() += 0.5F;
  parts.pca.basis *= 0.001F;  // nothing is clamped
  const Ddm model = parts.model();
  const Eigen::Vector2d z(0.3, -0.6);
  const Networks<double> nets(model.options(), 1);
  Mlp<double>::Tape tape;
  nets.decoder().forward(nets.decoderOf(model.theta().data()), z, &tape);
  const Eigen::MatrixXf image = model.pca().reconstruct(tape.output().cast<float>());
  const Image grey = model.decode(z);
  for (int i = 0; i < 64; ++i) EXPECT_NEAR(grey[i], 255.0F * image(i, 0), 0.501F);
}

/// z_{t+1} ... by hand, with the features and torques written out (n = 2).
Eigen::VectorXd predictedByHand(const Ddm& model, const DataSet& data, Eigen::Index frame,
                                int num_steps) {
  Eigen::VectorXd before = model.encode(data.image(frame - 1));
  Eigen::VectorXd now = model.encode(data.image(frame));
  for (int step = 0; step < num_steps; ++step) {
    const double scale = model.options().max_torque[0];
    Eigen::VectorXd h(6);
    h << now, data.torques()(0, frame + step) / scale, before,
        data.torques()(0, frame + step - 1) / scale;
    Mlp<double>::Tape tape;
    model.predictionModel().network().forward(model.thetaP(), h, &tape);
    before = now;
    now = tape.output();
  }
  return now;
}

TEST(Ddm, PredictsTheFirstStepOfARollOut) {
  const Ddm model = testing::toyModel();
  const DataSet data = testing::toyTrial(6, 1);
  const Eigen::MatrixXd Z = encodeAll(model, data);
  History x(2, model.featureDim(), 1);
  for (Eigen::Index t = 0; t < 4; ++t) {
    if (t > 0) x.apply(data.torques().col(t - 1));
    x.observe(Z.col(t));
  }
  EXPECT_TRUE(model.predict(x, data.torques().col(3))
                  .isApprox(model.rollOut(Z, data.torques(), 3, 1).col(1), 1e-14));
  EXPECT_FALSE(model.predict(x, data.torques().col(2))
                   .isApprox(model.rollOut(Z, data.torques(), 3, 1).col(1), 1e-6));
}

TEST(Ddm, RollsOutByItsOwnPredictions) {
  const Ddm model = testing::toyModel();
  const DataSet data = testing::toyTrial(8, 1);
  const Eigen::MatrixXd predicted = model.rollOut(encodeAll(model, data), data.torques(), 3, 3);
  for (int k = 1; k <= 3; ++k) {
    EXPECT_TRUE(predicted.col(k).isApprox(predictedByHand(model, data, 3, k), 1e-12)) << k;
  }
}

TEST(Ddm, RefusesAGoalFeatureWithoutAGoalAndAnImageOfAnotherSize) {
  const Ddm model = toyModel(/*with_goal=*/false);
  EXPECT_FALSE(model.hasGoal());
  EXPECT_TRUE(throwsNaming<std::logic_error>([&] { model.goalFeature(); }, {"goal image"}));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([] { toyModel().encode(Image(63)); },
                                                  {"64 pixels", "got 63"}));
}

TEST(Ddm, RefusesPartsThatDoNotFitAndValuesThatAreNotFinite) {
  const auto refuses = [](const std::function<void(Parts*)>& spoil, const std::string& fault) {
    Parts parts;
    spoil(&parts);
    return throwsNaming<std::invalid_argument>([&] { parts.model(); }, {fault, "train it again"});
  };
  EXPECT_NO_THROW(Parts().model());
  EXPECT_TRUE(refuses([](Parts* parts) { parts->image_size = 9; },
                      "pixels of the mean image must be 81, got 64"));
  EXPECT_TRUE(refuses([](Parts* parts) { parts->torque_dim = 2; }, "number of parameters"));
  EXPECT_TRUE(refuses([](Parts* parts) { parts->options.pca_dim = 5; },
                      "columns of the PCA basis must be 5, got "));
  EXPECT_TRUE(refuses([](Parts* parts) { parts->goal.pop_back(); },
                      "pixels of the goal image must be 64, got 63"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refuses([&](Parts* parts) { parts->theta[5] = nan; },
                      "parameters must be finite, number 5 is nan"));
  EXPECT_TRUE(refuses([&](Parts* parts) { parts->pca.mean[5] = nan; },
                      "mean image must be finite, number 5"));
  EXPECT_TRUE(
      refuses([&](Parts* parts) { parts->pca.basis(3, 3) = nan; }, "PCA basis must be finite"));
  EXPECT_TRUE(refuses([&](Parts* parts) { parts->pca.scale = 0.0F; },
                      "scale of PCA must be > 0 and finite, got 0"));
}

}  // namespace
}  // namespace ddm
