// pilco_benchmark: computing time of one long-term cost with its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ddm_pilco/gp_training.h"
#include "ddm_pilco/long_term_cost.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"

namespace ddm {
namespace pilco {
namespace {

constexpr int kCentres = 30;

/// Data of the dynamics, as trainGp() has them.
struct Transitions {
  Eigen::MatrixXd inputs;   ///< [D x n]
  Eigen::MatrixXd targets;  ///< [n x E]
};

Eigen::MatrixXd randomMatrix(int rows, int cols, double scale, std::mt19937_64* random) {
  std::normal_distribution<double> normal(0.0, scale);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&]() { return normal(*random); });
}

GpModel usable(const GpFit& fit) {
  if (!fit.ok) throw std::runtime_error("pilco_benchmark: " + fit.message);
  return fit.model;
}

/// Noisy measurements of a pendulum without gravity under random torques, in trials of 125 steps of
/// 0.2 s. Inputs: angular velocity, sine and cosine of the angle, torque.
Transitions pendulumData(int n, std::mt19937_64* random) {
  constexpr int kTrialSteps = 125;
  constexpr int kSubsteps = 200;
  constexpr double kTimeStep = 0.2 / kSubsteps;
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> torque(-6.0, 6.0);
  Transitions data{Eigen::MatrixXd(4, n), Eigen::MatrixXd(n, 2)};
  double rate = 0.0, angle = 0.0, seen_rate = 0.0, seen_angle = 0.0;
  const auto measure = [&]() {
    seen_rate = rate + 0.1 * normal(*random);
    seen_angle = angle + 0.01 * normal(*random);
  };
  for (int i = 0; i < n; ++i) {
    if (i % kTrialSteps == 0) {
      rate = 0.1 * normal(*random);
      angle = 0.1 * normal(*random);
      measure();
    }
    const double u = torque(*random);
    data.inputs.col(i) << seen_rate, std::sin(seen_angle), std::cos(seen_angle), u;
    data.targets.row(i) << -seen_rate, -seen_angle;
    for (int k = 0; k < kSubsteps; ++k) {
      rate += kTimeStep * 3.0 * (u - rate);
      angle += kTimeStep * rate;
    }
    measure();
    data.targets(i, 0) += seen_rate;
    data.targets(i, 1) += seen_angle;
  }
  return data;
}

/// Features that decay and are pushed by a torque, with noise; the GP's inputs are features and
/// torque.
Transitions featureData(int features, int n, std::mt19937_64* random) {
  const Eigen::VectorXd push = randomMatrix(features, 1, 0.1, random);
  Transitions data;
  data.inputs = randomMatrix(features + 1, n, 1.0, random);
  data.targets = -0.1 * data.inputs.topRows(features).transpose() +
                 data.inputs.row(features).transpose() * push.transpose() +
                 randomMatrix(n, features, 0.02, random);
  return data;
}

std::unique_ptr<SquashedPolicy> randomPolicy(int features, std::mt19937_64* random) {
  auto rbf = std::make_unique<RbfPolicy>(features, 1, kCentres);
  rbf->setParameters(RbfPolicy::packParameters(Eigen::VectorXd::Zero(features),
                                               randomMatrix(features, kCentres, 1.0, random),
                                               randomMatrix(kCentres, 1, 0.1, random)));
  return std::make_unique<SquashedPolicy>(std::move(rbf), Eigen::VectorXd::Constant(1, 6.0));
}

/// Times evaluate() with its gradient. A prediction that diverges ends early: it is an error.
void timeEvaluation(LongTermCost cost, const Eigen::VectorXd& parameters, benchmark::State* state) {
  for (auto _ : *state) {
    Eigen::VectorXd gradient;
    const double J = cost.evaluate(parameters, &gradient);
    benchmark::DoNotOptimize(gradient.data());
    if (std::isfinite(J) && gradient.allFinite()) continue;
    state->SkipWithError("the long-term cost is not finite");
    return;
  }
}

/// The pendulum of the paper's baseline on the true state. Arguments: points, horizon.
void pendulum(benchmark::State& state) {
  std::mt19937_64 random(1);
  const Transitions data = pendulumData(static_cast<int>(state.range(0)), &random);
  constexpr int kTrainingPoints = 125;  // the hyper-parameters of a trial are good enough here
  const GpFit trained = trainGp(data.inputs.leftCols(kTrainingPoints),
                                data.targets.topRows(kTrainingPoints), GpTrainingOptions());
  const GpModel model =
      usable(makeGpModel(data.inputs, data.targets, usable(trained).hyperparameters));
  PropagationOptions options;
  options.angles = {1};
  options.noisy_policy_input = true;
  const std::unique_ptr<SquashedPolicy> policy = randomPolicy(3, &random);
  const Gaussian start{Eigen::VectorXd::Zero(2), 0.01 * Eigen::MatrixXd::Identity(2, 2)};
  timeEvaluation(LongTermCost(Propagation(model, options), pendulumCost(), policy.get(), start,
                              static_cast<int>(state.range(1))),
                 policy->parameters(), &state);
}

/// Features of images, as many as the baseline on principal components has. Arguments: features,
/// points, horizon.
void features(benchmark::State& state) {
  std::mt19937_64 random(1);
  const int dim = static_cast<int>(state.range(0));
  const Transitions data = featureData(dim, static_cast<int>(state.range(1)), &random);
  const GpModel model = usable(
      makeGpModel(data.inputs, data.targets, initialHyperparameters(data.inputs, data.targets)));
  std::vector<int> all(static_cast<std::size_t>(dim));
  for (int i = 0; i < dim; ++i) all[static_cast<std::size_t>(i)] = i;
  const StateCost cost(
      Augmentation(dim, all, {}),
      SaturatingCost(Eigen::VectorXd::Ones(dim), Eigen::MatrixXd::Identity(dim, dim) / dim));
  const std::unique_ptr<SquashedPolicy> policy = randomPolicy(dim, &random);
  const Gaussian start{Eigen::VectorXd::Zero(dim), 0.01 * Eigen::MatrixXd::Identity(dim, dim)};
  timeEvaluation(LongTermCost(Propagation(model, PropagationOptions()), cost, policy.get(), start,
                              static_cast<int>(state.range(2))),
                 policy->parameters(), &state);
}

BENCHMARK(pendulum)
    ->ArgNames({"points", "horizon"})
    ->Args({250, 125})
    ->Args({1250, 125})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(features)
    ->ArgNames({"features", "points", "horizon"})
    ->Args({20, 100, 10})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilco
}  // namespace ddm

BENCHMARK_MAIN();
