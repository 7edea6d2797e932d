// Tests of predictions: single steps and rollouts.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "ddm_model/ddm.h"
#include "ddm_model/history.h"
#include "ddm_model/minimise.h"
#include "ddm_model/trainer.h"
#include "toy_data.h"

namespace ddm {
namespace {

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

TEST(Predict, IsTheFirstStepOfARollOut) {
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

TEST(RollOut, ReachesFromTheFirstPossibleFrameToTheLast) {
  const Ddm model = testing::toyModel();
  const DataSet data = testing::toyTrial(10, 1);
  const Eigen::MatrixXd Z = encodeAll(model, data);
  EXPECT_EQ(model.rollOut(Z, data.torques(), 1, 9).cols(), 10);
}

TEST(RollOut, AppliesTheNetworkToItsOwnPredictions) {
  const Ddm model = testing::toyModel();
  const DataSet data = testing::toyTrial(8, 1);
  const Eigen::MatrixXd predicted = model.rollOut(encodeAll(model, data), data.torques(), 3, 3);
  for (int k = 1; k <= 3; ++k) {
    EXPECT_TRUE(predicted.col(k).isApprox(predictedByHand(model, data, 3, k), 1e-12)) << k;
  }
}

}  // namespace
}  // namespace ddm
