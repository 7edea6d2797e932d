// Tests of the plan cost of an ensemble: mean, bonus for disagreement, gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/ensemble_plan_cost.h"

#include <ddm_model/testing/gradient_check.h>
#include <ddm_model/testing/random_matrix.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace ddm {
namespace {

/// J(U) = |U - centre|^2
class Bowl : public PlanCost {
 public:
  Bowl(double centre, int horizon) : centre_(centre), horizon_(horizon) {}

  double evaluate(const Eigen::Ref<const Eigen::MatrixXd>& U, Eigen::MatrixXd* d_U) override {
    const Eigen::MatrixXd difference = (U.array() - centre_).matrix();
    if (d_U != nullptr) *d_U = 2.0 * difference;
    return difference.squaredNorm();
  }
  Eigen::MatrixXd predictedFeatures() const override {
    return Eigen::MatrixXd::Constant(1, horizon_ + 1, centre_);
  }
  Eigen::VectorXd goalFeature() const override { return Eigen::VectorXd::Constant(1, centre_); }
  int horizon() const override { return horizon_; }
  int torqueDim() const override { return 1; }

 private:
  double centre_;
  int horizon_;
};

DifferentiableFunction functionOf(PlanCost* cost) {
  return [cost](const Eigen::VectorXd& u, Eigen::VectorXd* gradient) {
    Eigen::MatrixXd d_U;
    const double value = cost->evaluate(u.transpose(), gradient != nullptr ? &d_U : nullptr);
    if (gradient != nullptr) *gradient = d_U.transpose();
    return value;
  };
}

TEST(EnsemblePlanCost, OfASingleModelIsThatModels) {
  Bowl bowl(0.3, 4);
  EnsemblePlanCost ensemble({&bowl});
  ensemble.setBonus(2.0);
  const Eigen::MatrixXd U = testing::randomMatrix(1, 4, 1);
  Eigen::MatrixXd d_alone, d_ensemble;
  EXPECT_EQ(ensemble.evaluate(U, &d_ensemble), bowl.evaluate(U, &d_alone));
  EXPECT_EQ(d_ensemble, d_alone);
  EXPECT_EQ(ensemble.goalFeature(), bowl.goalFeature());
  EXPECT_EQ(ensemble.predictedFeatures(), bowl.predictedFeatures());
}

TEST(EnsemblePlanCost, IsTheMeanLessTheBonusTimesTheStandardDeviation) {
  Bowl first(0.0, 1), second(2.0, 1);
  EnsemblePlanCost ensemble({&first, &second});
  const Eigen::MatrixXd U = Eigen::MatrixXd::Constant(1, 1, 0.5);  // costs 0.25 and 2.25
  EXPECT_NEAR(ensemble.evaluate(U, nullptr), 1.25, 1e-15);
  ensemble.setBonus(0.5);
  EXPECT_NEAR(ensemble.evaluate(U, nullptr), 1.25 - 0.5 * 1.0, 1e-15);
}

TEST(EnsemblePlanCost, GradientMatchesDifferences) {
  Bowl first(0.0, 5), second(1.0, 5), third(-0.5, 5);
  EnsemblePlanCost ensemble({&first, &second, &third});
  for (const double bonus : {0.0, 0.7}) {
    ensemble.setBonus(bonus);
    EXPECT_TRUE(
        testing::gradientMatches(functionOf(&ensemble), testing::randomMatrix(5, 1, 3), 1e-6))
        << bonus;
  }
}

TEST(EnsemblePlanCost, WhereAllAgreeTheGradientIsFinite) {
  Bowl bowl(0.3, 3);
  EnsemblePlanCost ensemble({&bowl, &bowl});
  ensemble.setBonus(1.0);
  Eigen::MatrixXd d_U;
  ensemble.evaluate(Eigen::MatrixXd::Ones(1, 3), &d_U);
  EXPECT_TRUE(d_U.isApprox(Eigen::MatrixXd::Constant(1, 3, 1.4), 1e-12));
}

TEST(EnsemblePlanCost, RefusesModelsThatDoNotFit) {
  Bowl bowl(0.0, 3), longer(0.0, 4);
  EXPECT_THROW(EnsemblePlanCost({}), std::invalid_argument);
  EXPECT_THROW(EnsemblePlanCost({&bowl, &longer}), std::invalid_argument);
}

}  // namespace
}  // namespace ddm
