// Tests of the propagation and of the long-term cost: samples, derivatives, numerical trouble.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/long_term_cost.h"

#include <ddm_model/testing/vector_of.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "random_problems.h"

namespace ddm::pilco {
namespace {

using ::ddm::testing::vectorOf;

RbfPolicy randomPolicy(int dim, const Eigen::VectorXd& max_control, std::mt19937_64& random) {
  RbfPolicy policy(dim, 5, max_control);
  const int controls = policy.outputDim();
  policy.setParameters(RbfPolicy::packParameters(normalMatrix(dim, controls, 0.2, random),
                                                 normalMatrix(dim, 5, 1.0, random),
                                                 normalMatrix(5, controls, 0.3, random)));
  return policy;
}

/// A pendulum with little data: the state is [dphi, phi], and there is one torque.
struct Pendulum {
  explicit Pendulum(unsigned seed, bool noisy = false) : random(seed), noisy(noisy) {
    model = randomGp(4, 2, 12, true, random);
    model.beta *= 0.3;
    policy = randomPolicy(3, vectorOf({2.0}), random);
    start = randomGaussian(2, 2, 0.2, random);
  }

  Propagation propagation() const { return Propagation(model, {1}, noisy); }
  LongTermCost cost(int horizon) {
    return LongTermCost(propagation(), pendulumCost(), &policy, start, horizon);
  }

  std::mt19937_64 random;
  bool noisy;
  GpModel model;
  RbfPolicy policy{3, 5, vectorOf({2.0})};
  Gaussian start;
};

::testing::AssertionResult gradientMatches(LongTermCost* cost, const Eigen::VectorXd& parameters,
                                           double tolerance = 1e-7) {
  const auto J = [cost](const Eigen::VectorXd& at, Eigen::VectorXd* gradient) {
    return cost->evaluate(at, gradient);
  };
  return ddm::testing::gradientMatches(J, parameters, tolerance);
}

/// Without angles and with a policy that is linear near the state, state and control are jointly
/// Gaussian and the step is exact. The measurement noise is as large as the spread of the state.
TEST(Propagation, HasTheMomentsOfSamplesWhereAllIsGaussianAlsoIfThePolicySeesNoise) {
  for (const bool noisy : {false, true}) {
    std::mt19937_64 random(2);
    GpModel model = randomGp(3, 2, 8, true, random);
    const Eigen::VectorXd noise_std = vectorOf({0.5, 0.8});
    model.hyperparameters.row(4) = noise_std.array().log().matrix().transpose();
    // Two wide basis functions of opposite signs are linear near the state. The squashing is far
    // from its bound.
    Eigen::MatrixXd centres(2, 2);
    centres << 60.0, -60.0, -40.0, 40.0;
    const double kBound = 100.0, kScale = std::log(60.0);
    RbfPolicy policy(2, 2, vectorOf({kBound}));
    policy.setParameters(
        RbfPolicy::packParameters(vectorOf({kScale, kScale}), centres, vectorOf({0.2, -0.2})));
    const Gaussian state = randomGaussian(2, 2, 0.6, random);
    Propagation::Tape tape;
    const Gaussian next = Propagation(model, {}, noisy).step(policy, state, &tape);
    // cov(x, x') = s + s (gain from x to delta, directly and through the control)
    const Eigen::MatrixXd gain = Eigen::MatrixXd::Identity(2, 2) + tape.delta.gain.topRows(2) +
                                 tape.control.gain * tape.delta.gain.bottomRows(1);

    GpSampler delta(model, &random);
    std::normal_distribution<double> normal;
    // slope of the squashing at 0
    const double jitter = 1.5 * kBound * std::sqrt(RbfPolicy::kJitter);
    const auto sample = [&](const Eigen::VectorXd& x) {
      Eigen::VectorXd seen = x;
      for (int i = 0; noisy && i < 2; ++i)
        seen[i] += std::sqrt(0.5) * noise_std[i] * normal(random);
      const double u = policy.control(seen)[0] + jitter * normal(random);
      return Eigen::VectorXd(x + delta(vectorOf({x[0], x[1], u})));
    };
    EXPECT_TRUE(
        momentsMatchSamples(Moments{next.mean, next.covariance, gain}, state, sample, random))
        << (noisy ? "noisy" : "");
  }
}

TEST(LongTermCost, IsTheSumOverTheStepsWithoutTheStart) {
  Pendulum pendulum(6);
  LongTermCost cost = pendulum.cost(3);
  const double J = cost.evaluate(pendulum.policy.parameters());
  const Propagation propagation = pendulum.propagation();
  Gaussian state = pendulum.start;
  double expected = 0.0;
  ASSERT_EQ(cost.states().size(), 4u);
  ASSERT_EQ(cost.costs().size(), 3u);
  for (int t = 0; t < 3; ++t) {
    state = propagation.step(pendulum.policy, state);
    EXPECT_EQ(cost.states()[t + 1].mean, state.mean);
    EXPECT_EQ(cost.costs()[t], pendulumCost().expected(state));
    EXPECT_EQ(cost.costStandardDeviations()[t], std::sqrt(pendulumCost().variance(state)));
    expected += cost.costs()[t];
  }
  EXPECT_EQ(J, expected);
}

TEST(LongTermCost, GradientMatchesDifferencesOverManySteps) {
  Pendulum noisy(7, true), plain(7, false);
  LongTermCost with_noise = noisy.cost(12), without = plain.cost(12);
  EXPECT_TRUE(gradientMatches(&with_noise, noisy.policy.parameters()));
  EXPECT_TRUE(gradientMatches(&without, plain.policy.parameters()));
}

TEST(LongTermCost, GradientMatchesDifferencesWithoutAnglesAndForTwoControls) {
  std::mt19937_64 random(9);
  GpModel model = randomGp(5, 3, 10, true, random);
  model.beta *= 0.3;
  RbfPolicy policy = randomPolicy(3, vectorOf({1.0, 2.0}), random);
  const StateCost state_cost(replaceAngles(3, {}), vectorOf({0.5, 0.0, -0.5}),
                             Eigen::MatrixXd::Identity(3, 3));
  LongTermCost cost(Propagation(model, {}, false), state_cost, &policy,
                    randomGaussian(3, 3, 0.2, random), 6);
  EXPECT_TRUE(gradientMatches(&cost, policy.parameters()));
}

TEST(LongTermCost, IsNaNWithAGradientOfNaNWhereNothingCanBePredicted) {
  Pendulum pendulum(10);
  LongTermCost cost = pendulum.cost(4);
  const Eigen::VectorXd good = pendulum.policy.parameters();
  Eigen::VectorXd bad = good;
  bad[4] = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd gradient;
  EXPECT_TRUE(std::isnan(cost.evaluate(bad, &gradient)));
  EXPECT_EQ(gradient.size(), good.size());
  EXPECT_TRUE(gradient.array().isNaN().all());
  EXPECT_EQ(cost.states().size(), 1u);
  EXPECT_TRUE(std::isfinite(cost.evaluate(good, &gradient)));  // later calls work again
  EXPECT_TRUE(gradient.allFinite());
}

}  // namespace
}  // namespace ddm::pilco
