// Tests of the propagation and of the long-term cost: samples, derivatives, numerical trouble.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/long_term_cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "adjoint_check.h"
#include "ddm_model/testing/vector_of.h"
#include "ddm_msgs/testing/expect_error.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"
#include "gp_sampler.h"
#include "linear_policy.h"
#include "monte_carlo.h"
#include "random_gp.h"

namespace ddm {
namespace pilco {
namespace {

using ::ddm::testing::throwsNaming;
using ::ddm::testing::vectorOf;

/// A pendulum that has been seen only a few times: state [dphi, phi], one torque.
struct Pendulum {
  explicit Pendulum(unsigned seed, bool noisy = false) : random(seed) {
    model = randomGp(4, 2, 12, true, random);
    model.beta *= 0.3;
    options.angles = {1};
    options.noisy_policy_input = noisy;
    auto rbf = std::make_unique<RbfPolicy>(3, 1, 5);
    rbf->setParameters(RbfPolicy::packParameters(normalMatrix(3, 1, 0.2, random),
                                                 normalMatrix(3, 5, 1.0, random),
                                                 normalMatrix(5, 1, 0.3, random)));
    policy = std::make_unique<SquashedPolicy>(std::move(rbf), Eigen::VectorXd::Constant(1, 2.0));
    start = randomGaussian(2, 2, 0.2, random);
  }

  LongTermCost cost(int horizon) {
    return LongTermCost(Propagation(model, options), pendulumCost(), policy.get(), start, horizon);
  }

  std::mt19937_64 random;
  GpModel model;
  PropagationOptions options;
  std::unique_ptr<SquashedPolicy> policy;
  Gaussian start;
};

/// Without angles and with a linear policy, state and control are jointly Gaussian, and the step is
/// exact.
/// @param noisy  whether the policy sees a measurement with noise
::testing::AssertionResult stepMatchesSamples(bool noisy, std::mt19937_64& random) {
  GpModel model = randomGp(3, 2, 8, true, random);
  model.hyperparameters.log_noise_std = vectorOf({std::log(0.5), std::log(0.8)});
  PropagationOptions options;
  options.noisy_policy_input = noisy;
  LinearPolicy policy(2, 1);
  const Eigen::VectorXd w = normalMatrix(3, 1, 0.7, random);
  policy.setParameters(w);
  const Gaussian state = randomGaussian(2, 2, 0.6, random);
  const Gaussian next = Propagation(model, options).step(&policy, state);

  GpSampler delta(model, &random);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd noise_std = (noisy ? std::sqrt(0.5) : 0.0) * vectorOf({0.5, 0.8});
  const auto sample = [&](const Eigen::VectorXd& x) {
    const double u = w[0] * (x[0] + noise_std[0] * normal(random)) +
                     w[1] * (x[1] + noise_std[1] * normal(random)) + w[2];
    return Eigen::VectorXd(x + delta(vectorOf({x[0], x[1], u})));
  };
  return momentsMatchSamples(Moments{next.mean, next.covariance, Eigen::MatrixXd()}, state, sample,
                             random);
}

TEST(Propagation, HasTheMomentsOfAMillionSamplesWhereAllIsGaussian) {
  std::mt19937_64 random(1);
  EXPECT_TRUE(stepMatchesSamples(false, random));
}

TEST(Propagation, HasTheMomentsOfAMillionSamplesWhereThePolicySeesNoise) {
  std::mt19937_64 random(2);
  EXPECT_TRUE(stepMatchesSamples(true, random));
}

TEST(Propagation, AddsThePlainPredictionToAKnownState) {
  Pendulum pendulum(3);
  const Eigen::VectorXd x = vectorOf({0.4, 2.0});
  Propagation propagation(pendulum.model, pendulum.options);
  const Gaussian next =
      propagation.step(pendulum.policy.get(), Gaussian{x, Eigen::MatrixXd::Zero(2, 2)});
  const Eigen::VectorXd features = vectorOf({0.4, std::sin(2.0), std::cos(2.0)});
  Eigen::VectorXd input(4);
  input << features, pendulum.policy->control(features);
  GpModel mean_only = pendulum.model;
  mean_only.inverse.clear();
  const Eigen::VectorXd expected = x + GpSampler(mean_only, &pendulum.random)(input);
  EXPECT_LE((next.mean - expected).norm(), 1e-4);  // the jitter of the policy is not zero
}

TEST(Propagation, AdjointMatchesDifferencesWithAndWithoutNoiseAtThePolicy) {
  for (const bool noisy : {false, true}) {
    for (const int rank : {2, 1, 0}) {
      Pendulum pendulum(4, noisy);
      Propagation propagation(pendulum.model, pendulum.options);
      Policy* const policy = pendulum.policy.get();
      const auto map = [&](const Gaussian& state) {
        const Gaussian next = propagation.step(policy, state);
        return Moments{next.mean, next.covariance, Eigen::MatrixXd::Zero(2, 2)};
      };
      const auto adjoint = [&](const Gaussian& state, const Moments& d_output) {
        Propagation::Tape tape;
        propagation.step(policy, state, &tape);
        return propagation.backward(policy, tape, Gaussian{d_output.mean, d_output.covariance},
                                    nullptr);
      };
      EXPECT_TRUE(adjointMatches(map, adjoint, randomGaussian(2, rank, 0.4, pendulum.random),
                                 pendulum.random))
          << "rank " << rank << (noisy ? ", noisy" : "");
    }
  }
}

TEST(Propagation, RefusesModelsPoliciesAndStatesThatDoNotFit) {
  Pendulum pendulum(5);
  PropagationOptions options;
  options.angles = {2};
  EXPECT_THROW(Propagation(pendulum.model, options), std::invalid_argument);
  options.angles = {0, 1};  // four features: no input is left for a control
  const auto construct = [&] { Propagation(pendulum.model, options); };
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(construct, {"4 features", "got 4"}));
  options.angles = {1};
  options.noisy_policy_input = true;
  GpModel without_noise = pendulum.model;
  without_noise.hyperparameters.log_noise_std.resize(0);
  EXPECT_THROW(Propagation(without_noise, options), std::invalid_argument);

  Propagation propagation(pendulum.model, pendulum.options);
  LinearPolicy other(2, 1);
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { propagation.step(&other, pendulum.start); },
                                                  {"3 features and 1 controls, got 2 and 1"}));
  EXPECT_THROW(propagation.step(pendulum.policy.get(), randomGaussian(3, 3, 0.1, pendulum.random)),
               std::invalid_argument);
}

TEST(LongTermCost, IsTheSumOverTheStepsWithoutTheStart) {
  Pendulum pendulum(6);
  LongTermCost cost = pendulum.cost(3);
  const double J = cost.evaluate(pendulum.policy->parameters());
  Propagation propagation(pendulum.model, pendulum.options);
  Gaussian state = pendulum.start;
  double expected = 0.0;
  ASSERT_EQ(cost.states().size(), 4u);
  ASSERT_EQ(cost.costs().size(), 3u);
  for (int t = 0; t < 3; ++t) {
    state = propagation.step(pendulum.policy.get(), state);
    EXPECT_EQ(cost.states()[t + 1].mean, state.mean);
    EXPECT_EQ(cost.costs()[t], pendulumCost().expected(state));
    EXPECT_EQ(cost.costStandardDeviations()[t], std::sqrt(pendulumCost().variance(state)));
    expected += cost.costs()[t];
  }
  EXPECT_EQ(J, expected);
}

TEST(LongTermCost, GradientMatchesDifferencesOverManySteps) {
  for (const bool noisy : {false, true}) {
    for (const int horizon : {1, 12}) {
      Pendulum pendulum(7, noisy);
      LongTermCost cost = pendulum.cost(horizon);
      const auto J = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
        return cost.evaluate(parameters, gradient);
      };
      EXPECT_TRUE(ddm::testing::gradientMatches(J, pendulum.policy->parameters()))
          << horizon << " steps" << (noisy ? ", noisy" : "");
    }
  }
}

TEST(LongTermCost, GradientMatchesDifferencesFromAKnownStart) {
  Pendulum pendulum(8, true);
  pendulum.start.covariance.setZero();
  LongTermCost cost = pendulum.cost(5);
  const auto J = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
    return cost.evaluate(parameters, gradient);
  };
  EXPECT_TRUE(ddm::testing::gradientMatches(J, pendulum.policy->parameters()));
}

TEST(LongTermCost, GradientMatchesDifferencesWithoutAnglesAndForTwoControls) {
  std::mt19937_64 random(9);
  GpModel model = randomGp(5, 3, 10, true, random);
  model.beta *= 0.3;
  auto rbf = std::make_unique<RbfPolicy>(3, 2, 4);
  rbf->setParameters(normalMatrix(rbf->numParameters(), 1, 0.4, random));
  SquashedPolicy policy(std::move(rbf), vectorOf({1.0, 2.0}));
  const StateCost state_cost(
      Augmentation(3, {0, 1, 2}, {}),
      SaturatingCost(vectorOf({0.5, 0.0, -0.5}), Eigen::MatrixXd::Identity(3, 3)));
  LongTermCost cost(Propagation(model, PropagationOptions()), state_cost, &policy,
                    randomGaussian(3, 3, 0.2, random), 6);
  const auto J = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
    return cost.evaluate(parameters, gradient);
  };
  EXPECT_TRUE(ddm::testing::gradientMatches(J, policy.parameters()));
}

TEST(LongTermCost, IsFiniteWithARightGradientForAPolicyAtItsBound) {
  Pendulum pendulum(12);
  pendulum.start.covariance *= 0.01;
  Eigen::VectorXd saturated = pendulum.policy->parameters();
  // log length-scales; with 0.4 rounding is a hundred times as large
  saturated.head(3).setConstant(0.2);
  saturated.tail(5).setConstant(9.0);
  RbfPolicy before_squashing(3, 1, 5);
  before_squashing.setParameters(saturated);
  const Eigen::VectorXd& x = pendulum.start.mean;
  EXPECT_GT(before_squashing
                .predict(Gaussian{vectorOf({x[0], std::sin(x[1]), std::cos(x[1])}),
                                  Eigen::MatrixXd::Zero(3, 3)})
                .mean[0],
            4.0)
      << "beyond the first maximum of the squashing, at 1.6";
  LongTermCost cost = pendulum.cost(6);
  const auto J = [&](const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
    return cost.evaluate(parameters, gradient);
  };
  Eigen::VectorXd gradient;
  const double value = J(saturated, &gradient);
  EXPECT_TRUE(value > 0.0 && value < 6.0) << value;
  EXPECT_GT(gradient.lpNorm<Eigen::Infinity>(), 1e-3);
  EXPECT_TRUE(ddm::testing::gradientMatches(J, saturated, 1e-6));
}

TEST(LongTermCost, IsNaNWithAGradientOfNaNWhereNothingCanBePredicted) {
  Pendulum pendulum(10);
  LongTermCost cost = pendulum.cost(4);
  const Eigen::VectorXd good = pendulum.policy->parameters();
  Eigen::VectorXd bad = good;
  bad[4] = std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd gradient;
  EXPECT_TRUE(std::isnan(cost.evaluate(bad, &gradient)));
  EXPECT_EQ(gradient.size(), good.size());
  EXPECT_TRUE(gradient.array().isNaN().all());
  EXPECT_EQ(cost.states().size(), 1u);
  EXPECT_TRUE(std::isfinite(cost.evaluate(good, &gradient)));  // and it recovers
  EXPECT_TRUE(gradient.allFinite());
}

TEST(LongTermCost, RefusesProblemsThatDoNotFit) {
  Pendulum pendulum(11);
  const auto make = [&](Policy* policy, const StateCost& state_cost, const Gaussian& start,
                        int horizon) {
    LongTermCost(Propagation(pendulum.model, pendulum.options), state_cost, policy, start, horizon);
  };
  Policy* const policy = pendulum.policy.get();
  EXPECT_NO_THROW(make(policy, pendulumCost(), pendulum.start, 1));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { make(policy, pendulumCost(), pendulum.start, 0); }, {"horizon", ">= 1, got 0"}));
  EXPECT_THROW(make(nullptr, pendulumCost(), pendulum.start, 1), std::invalid_argument);
  LinearPolicy other(2, 1);
  EXPECT_THROW(make(&other, pendulumCost(), pendulum.start, 1), std::invalid_argument);
  const StateCost of_three(
      Augmentation(3, {0}, {}),
      SaturatingCost(Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Identity(1, 1)));
  EXPECT_TRUE(throwsNaming<std::invalid_argument>(
      [&] { make(policy, of_three, pendulum.start, 1); }, {"state of 2", " 3"}));
  Gaussian start = pendulum.start;
  start.mean[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(throwsNaming<std::invalid_argument>([&] { make(policy, pendulumCost(), start, 1); },
                                                  {"initial state", "finite", "nan"}));
  LongTermCost cost = pendulum.cost(2);
  EXPECT_THROW(cost.evaluate(Eigen::VectorXd::Zero(3)), std::invalid_argument);
}

}  // namespace
}  // namespace pilco
}  // namespace ddm
