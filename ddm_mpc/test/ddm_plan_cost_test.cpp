// Tests of the plan cost: value and gradient against slow and independent computations.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ddm_plan_cost.h"

#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "random_model.h"

namespace ddm {
namespace {

constexpr double kControlWeight = 0.03;

/// J(U) written down once more, with lists instead of matrices: the newest feature and torque stand
/// in front.
double slowCost(const Ddm& model, const History& x, const Eigen::VectorXd& goal,
                const Eigen::MatrixXd& U, std::vector<Eigen::VectorXd>* predicted = nullptr) {
  std::deque<Eigen::VectorXd> features, torques;
  for (Eigen::Index lag = 0; lag < x.features().cols(); ++lag) {
    features.push_back(x.features().col(lag));
  }
  for (Eigen::Index lag = 0; lag < x.torques().cols(); ++lag) {
    torques.push_back(x.torques().col(lag));
  }
  double cost = 0.0;
  for (Eigen::Index k = 0; k < U.cols(); ++k) {
    torques.push_front(U.col(k));
    std::vector<double> h;
    for (int lag = 0; lag < model.options().order; ++lag) {
      h.insert(h.end(), features[lag].data(), features[lag].data() + features[lag].size());
      const Eigen::VectorXd& torque = torques[lag];
      for (Eigen::Index i = 0; i < torque.size(); ++i) {
        h.push_back(torque[i] / model.predictionModel().maxTorque()[i]);
      }
    }
    Mlp<double>::Tape tape;
    model.predictionModel().network().forward(
        model.thetaP(), Eigen::Map<const Eigen::VectorXd>(h.data(), h.size()), &tape);
    features.push_front(tape.output());
    cost += (features.front() - goal).squaredNorm() + kControlWeight * U.col(k).squaredNorm();
    if (predicted != nullptr) predicted->push_back(features.front());
  }
  return cost;
}

TEST(DdmPlanCost, ValueGradientAndFeaturesEqualSlowComputationsForModelsOfAllShapes) {
  struct Shape {
    int order, torque_dim, horizon;
  };
  for (const Shape& shape : {Shape{1, 1, 1}, {1, 2, 7}, {3, 1, 7}, {3, 2, 1}, {3, 2, 7}}) {
    SCOPED_TRACE(::testing::Message() << "order " << shape.order << ", " << shape.torque_dim
                                      << " motors, horizon " << shape.horizon);
    RandomModelOptions options;
    options.model.order = shape.order;
    options.torque_dim = shape.torque_dim;
    if (options.torque_dim == 2) options.model.max_torque = {4.0, 2.0};
    options.gain = 0.7;
    const Ddm model = randomModel(options);
    const History x = randomHistory(model, /*seed=*/10);
    const Eigen::VectorXd goal = testing::randomMatrix(2, 1, 20);
    const Eigen::MatrixXd U = 2.0 * testing::randomMatrix(shape.torque_dim, shape.horizon, 30);
    DdmPlanCost cost(model, shape.horizon, kControlWeight);
    cost.setProblem(randomHistory(model, 7), goal);
    cost.evaluate(U, nullptr);  // an earlier problem, which is to be forgotten
    cost.setProblem(x, goal);
    EXPECT_TRUE(gradientMatches(&cost, U));
    std::vector<Eigen::VectorXd> predicted;
    const double expected = slowCost(model, x, goal, U, &predicted);
    EXPECT_NEAR(cost.evaluate(U, nullptr), expected, 1e-12 * expected);
    const Eigen::MatrixXd features = cost.predictedFeatures();
    ASSERT_EQ(features.cols(), shape.horizon + 1);
    EXPECT_EQ(features.col(0), x.features().col(0)) << "the first one is z_0";
    for (int k = 0; k < shape.horizon; ++k) {
      EXPECT_TRUE(features.col(k + 1).isApprox(predicted[k], 1e-12)) << "step " << k + 1;
    }
  }
}

TEST(DdmPlanCost, GradientMatchesDifferencesWithAnOffset) {
  RandomModelOptions options;
  options.gain = 0.7;
  const Ddm model = randomModel(options);
  DdmPlanCost cost(model, 6, kControlWeight);
  cost.setProblem(randomHistory(model, 10), testing::randomMatrix(2, 1, 20),
                  0.1 * testing::randomMatrix(2, 1, 30));
  EXPECT_TRUE(gradientMatches(&cost, 2.0 * testing::randomMatrix(1, 6, 30)));
}

}  // namespace
}  // namespace ddm
