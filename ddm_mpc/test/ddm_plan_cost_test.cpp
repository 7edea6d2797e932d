// Tests of the plan cost: value and gradient against slow and independent computations.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ddm_plan_cost.h"

#include <ddm_model/testing/gradient_check.h>
#include <gtest/gtest.h>

#include <deque>
#include <stdexcept>
#include <tuple>

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
      const Eigen::VectorXd& torque = torques[lag + model.options().delay];
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

/// order, torque_dim, horizon, delay
class DdmPlanCostShapes : public ::testing::TestWithParam<std::tuple<int, int, int, int>> {
 protected:
  static RandomModelOptions modelOptions() {
    RandomModelOptions options;
    options.model.order = std::get<0>(GetParam());
    options.torque_dim = std::get<1>(GetParam());
    options.model.delay = std::get<3>(GetParam());
    if (options.torque_dim == 2) options.model.max_torque = {4.0, 2.0};
    options.gain = 0.7;
    return options;
  }
  const Ddm model_ = randomModel(modelOptions());
  const int horizon_ = std::get<2>(GetParam());
  const History x_ = randomHistory(model_, /*seed=*/10);
  const Eigen::VectorXd goal_ = testing::randomMatrix(2, 1, 20);
  const Eigen::MatrixXd U_ = 2.0 * testing::randomMatrix(model_.torqueDim(), horizon_, 30);
};

TEST_P(DdmPlanCostShapes, GradientMatchesFiniteDifferences) {
  DdmPlanCost cost(model_, horizon_, kControlWeight);
  cost.setProblem(x_, goal_);
  const auto f = [&](const Eigen::VectorXd& u, Eigen::VectorXd* gradient) {
    const Eigen::Map<const Eigen::MatrixXd> U(u.data(), model_.torqueDim(), horizon_);
    Eigen::MatrixXd d_U;
    const double value = cost.evaluate(U, gradient != nullptr ? &d_U : nullptr);
    if (gradient != nullptr) {
      *gradient = Eigen::Map<const Eigen::VectorXd>(d_U.data(), d_U.size());
    }
    return value;
  };
  const Eigen::VectorXd u = Eigen::Map<const Eigen::VectorXd>(U_.data(), U_.size());
  EXPECT_TRUE(testing::gradientMatches(f, u, 1e-6));
}

TEST_P(DdmPlanCostShapes, ValueAndPredictedFeaturesEqualASlowComputation) {
  DdmPlanCost cost(model_, horizon_, kControlWeight);
  cost.setProblem(x_, goal_);
  std::vector<Eigen::VectorXd> predicted;
  const double expected = slowCost(model_, x_, goal_, U_, &predicted);
  EXPECT_NEAR(cost.evaluate(U_, nullptr), expected, 1e-12 * expected);
  const Eigen::MatrixXd features = cost.predictedFeatures();
  ASSERT_EQ(features.cols(), horizon_ + 1);
  EXPECT_EQ(features.col(0), x_.features().col(0)) << "the first one is z_0";
  for (int k = 0; k < horizon_; ++k) {
    EXPECT_TRUE(features.col(k + 1).isApprox(predicted[k], 1e-12)) << "step " << k + 1;
  }
}

TEST(DdmPlanCost, GradientMatchesDifferencesForEveryFormOfFAndWithAnOffset) {
  for (const bool residual : {false, true}) {
    RandomModelOptions options;
    options.model.residual = residual;
    options.model.increments = residual;
    options.model.order = residual ? 3 : 2;
    options.gain = 0.7;
    const Ddm model = randomModel(options);
    DdmPlanCost cost(model, 6, kControlWeight);
    cost.setProblem(randomHistory(model, 10), testing::randomMatrix(2, 1, 20),
                    0.1 * testing::randomMatrix(2, 1, 30));
    const auto f = [&](const Eigen::VectorXd& u, Eigen::VectorXd* gradient) {
      Eigen::MatrixXd d_U;
      const double value = cost.evaluate(u.transpose(), gradient != nullptr ? &d_U : nullptr);
      if (gradient != nullptr) *gradient = d_U.transpose();
      return value;
    };
    EXPECT_TRUE(testing::gradientMatches(f, 2.0 * testing::randomMatrix(6, 1, 30), 1e-6))
        << residual;
  }
}

INSTANTIATE_TEST_SUITE_P(OrdersTorquesHorizonsDelays, DdmPlanCostShapes,
                         ::testing::Combine(::testing::Values(1, 3), ::testing::Values(1, 2),
                                            ::testing::Values(1, 7), ::testing::Values(0, 2)));

TEST(DdmPlanCost, ForgetsTheLastProblem) {
  const Ddm model = randomModel({});
  const Eigen::MatrixXd U = testing::randomMatrix(1, 4, 1);
  const History x = randomHistory(model, 5);
  const Eigen::VectorXd goal = testing::randomMatrix(2, 1, 6);
  DdmPlanCost used(model, 4, kControlWeight);
  used.setProblem(randomHistory(model, 7), testing::randomMatrix(2, 1, 8));
  Eigen::MatrixXd d_used;
  used.evaluate(U, &d_used);
  used.setProblem(x, goal);
  DdmPlanCost fresh(model, 4, kControlWeight);
  fresh.setProblem(x, goal);
  Eigen::MatrixXd d_fresh;
  EXPECT_EQ(used.evaluate(U, &d_used), fresh.evaluate(U, &d_fresh));
  EXPECT_EQ(d_used, d_fresh);
}

TEST(DdmPlanCost, RefusesWhatDoesNotFitTheModel) {
  const Ddm model = randomModel({});
  EXPECT_THROW(DdmPlanCost(model, 0, kControlWeight), std::invalid_argument);
  DdmPlanCost cost(model, 3, kControlWeight);
  const Eigen::Vector2d goal(0.0, 0.0);
  EXPECT_THROW(cost.setProblem(History(2, 2, 1), goal), std::invalid_argument) << "no image";
  History of_another(3, 2, 1);
  of_another.observe(goal);
  EXPECT_THROW(cost.setProblem(of_another, goal), std::invalid_argument);
  EXPECT_THROW(cost.setProblem(randomHistory(model, 1), Eigen::Vector3d::Zero()),
               std::invalid_argument);
}

}  // namespace
}  // namespace ddm
