// pilco_check: steps of the state distribution, long-term costs, and a stored run of the authors.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <vector>

#include "check/gp_fields.h"
#include "check/jacobian.h"
#include "check/kinds.h"
#include "check/published_gradient.h"
#include "check/scenario.h"
#include "ddm_pilco/long_term_cost.h"
#include "ddm_pilco/rbf_policy.h"
#include "ddm_pilco/squashed_policy.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

constexpr int kStateDim = 2;    // angular velocity, angle
constexpr int kFeatureDim = 3;  // angular velocity, sine, cosine
constexpr Tolerance kState = absolute(1e-9);
constexpr Tolerance kGradient = relative(1e-6);
constexpr double kFileDifferenceStep = 1e-3;
constexpr double kFineDifferenceStep = 1e-4;

/// What all of these kinds consist of.
struct Setting {
  GpData data;
  PropagationOptions options;
  Eigen::VectorXd policy_parameters;
  std::unique_ptr<SquashedPolicy> policy;
};

Setting readSetting(Case* reference) {
  Setting setting;
  const Scenario scenario = readScenario(reference);
  setting.options.angles = {1};
  setting.options.noisy_policy_input = reference->flag("policy_input_noise_added");
  if (setting.options.noisy_policy_input != scenario.noisy_policy_input) {
    reference->fail("policy_input_noise_added", "does not fit the scenario");
  }
  setting.data = readGpData(reference);
  if (setting.data.inputs.rows() != kFeatureDim + 1) reference->fail("X", "must have 4 columns");
  if (setting.data.targets.cols() != kStateDim) reference->fail("Y", "must have 2 columns");

  const Eigen::MatrixXd centres = reference->matrix("centres");
  if (centres.cols() != kFeatureDim) reference->fail("centres", "must have 3 columns");
  const int num_centres = static_cast<int>(centres.rows());
  setting.policy_parameters =
      RbfPolicy::packParameters(reference->vector("log_ls", kFeatureDim), centres.transpose(),
                                reference->vector("targets", num_centres));
  auto rbf = std::make_unique<RbfPolicy>(kFeatureDim, 1, num_centres);
  rbf->setParameters(setting.policy_parameters);
  setting.policy = std::make_unique<SquashedPolicy>(
      std::move(rbf), Eigen::VectorXd::Constant(1, reference->number("maxU")));
  return setting;
}

GpModel readModel(Case* reference, const GpData& data) {
  return usable(
      makeGpModel(data.inputs, data.targets, readHyperparameters(reference, "loghyp", data)),
      *reference);
}

Rollout readRollout(Case* reference, const Setting& setting) {
  reference->compareVector("target", Eigen::Vector2d(0.0, M_PI), absolute(1e-12));
  const Eigen::Index horizon = reference->matrix("means_0_to_H").rows() - 1;
  reference->requireCount("H", horizon);
  return {readModel(reference, setting.data),
          setting.options,
          pendulumCost(1.0, reference->number("width")),
          {reference->vector("m0", kStateDim), reference->covariance("s0", kStateDim)},
          static_cast<int>(horizon)};
}

LongTermCost makeCost(const Rollout& rollout, Policy* policy) {
  return LongTermCost(Propagation(rollout.dynamics, rollout.options), rollout.cost, policy,
                      rollout.initial_state, rollout.horizon);
}

Eigen::VectorXd toVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Means and covariances for t = 0 ... H.
void compareStates(Case* reference, const std::vector<Gaussian>& states,
                   const Tolerance& tolerance) {
  const Eigen::Index count = static_cast<Eigen::Index>(states.size());
  Eigen::MatrixXd means(count, kStateDim);
  Eigen::VectorXd var_rate(count), var_angle(count), covariance(count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Gaussian& state = states[static_cast<std::size_t>(t)];
    means.row(t) = state.mean.transpose();
    var_rate[t] = state.covariance(0, 0);
    var_angle[t] = state.covariance(1, 1);
    covariance[t] = state.covariance(0, 1);
  }
  reference->compareMatrix("means_0_to_H", means, tolerance);
  reference->compareVector("var_dphi_0_to_H", var_rate, tolerance);
  reference->compareVector("var_phi_0_to_H", var_angle, tolerance);
  reference->compareVector("cov_dphi_phi_0_to_H", covariance, tolerance);
}

/// A gradient that the file has in parts, as one vector like the policy's parameters.
Eigen::VectorXd readGradient(Case* reference, const std::string& field, Eigen::Index num_centres) {
  Case parts = reference->group(field);
  const Eigen::VectorXd out =
      RbfPolicy::packParameters(parts.vector("log_ls", kFeatureDim),
                                parts.matrix("centres", num_centres, kFeatureDim).transpose(),
                                parts.vector("targets", num_centres));
  parts.requireAllRead();
  return out;
}

}  // namespace

void checkPropagation(Case* reference) {
  const Setting setting = readSetting(reference);
  Propagation propagation(readModel(reference, setting.data), setting.options);
  const Gaussian state = {reference->vector("m", kStateDim), reference->covariance("s", kStateDim)};
  Propagation::Tape tape;
  const Gaussian next = propagation.step(setting.policy.get(), state, &tape);
  reference->compareVector("m_next", next.mean, kState);
  reference->compareMatrix("s_next", next.covariance, kState);
  if (!reference->hasGroup({"dMdm", "dSdm", "dMds", "dSds"})) return;
  const auto backward = [&](const Gaussian& seed) {
    return propagation.backward(setting.policy.get(), tape, seed, nullptr);
  };
  Gaussian seed = constantGaussian(kStateDim);
  const auto compare = [&](const std::string& name, const Jacobian& computed) {
    const Eigen::MatrixXd in_covariance = reference->matrix("d" + name + "ds");
    reference->compareMatrix("d" + name + "dm", computed.mean, relative(1e-9));
    reference->compare("d" + name + "ds", symmetrized(in_covariance, kStateDim),
                       computed.covariance, relative(1e-9));
  };
  compare("M", jacobian(&seed, &seed.mean, kStateDim, backward));
  compare("S", jacobian(&seed, &seed.covariance, kStateDim, backward));
}

void checkValue(Case* reference) {
  const Setting setting = readSetting(reference);
  const Rollout rollout = readRollout(reference, setting);
  LongTermCost cost = makeCost(rollout, setting.policy.get());
  Eigen::VectorXd exact;
  reference->compareNumber("J", cost.evaluate(setting.policy_parameters, &exact), kState);
  reference->compareVector("cost_per_step_1_to_H", toVector(cost.costs()), kState);
  compareStates(reference, cost.states(), kState);

  // The differences of the file have truncation errors of their own, beyond the tolerance where J
  // bends much. So like is compared with like, and the exact gradient with finer differences; how
  // far it is from those of the file is told only.
  const Eigen::Index num_centres = (exact.size() - kFeatureDim) / (kFeatureDim + 1);
  const auto compare = [&](const std::string& field, const Eigen::VectorXd& computed) {
    reference->compare(field, readGradient(reference, field, num_centres), computed, kGradient);
  };
  compare("grad_finite_difference",
          differenceGradient(&cost, setting.policy_parameters, kFileDifferenceStep));
  reference->compare("finer differences than grad_finite_difference",
                     differenceGradient(&cost, setting.policy_parameters, kFineDifferenceStep),
                     exact, kGradient);
  reference->report("exact gradient against the file's differences",
                    readGradient(reference, "grad_finite_difference", num_centres), exact);
  setting.policy->setParameters(setting.policy_parameters);
  compare("grad_as_implemented", publishedGradient(rollout, setting.policy.get()));
}

void checkAuthors(Case* reference) {
  const Tolerance tolerance = relative(1e-5);
  const Setting setting = readSetting(reference);
  const GpData& data = setting.data;
  reference->requireCount("n", data.inputs.cols());

  const Hyperparameters start = readHyperparameters(reference, "loghyp_init", data);
  reference->compareMatrix(
      "loghyp_init", toMatrix(initialHyperparameters(data.inputs, data.targets)), absolute(1e-9));
  const GpFit fit = trainGp(data.inputs, data.targets, GpTrainingOptions(), &start);
  reference->compareMatrix("loghyp", toMatrix(usable(fit, *reference).hyperparameters), tolerance);
  Eigen::VectorXd likelihoods(kStateDim);
  for (int a = 0; a < kStateDim; ++a) likelihoods[a] = fit.outputs[a].final_cost;
  reference->compareVector("nlml_curb", likelihoods, tolerance);

  const Rollout rollout = readRollout(reference, setting);
  LongTermCost cost = makeCost(rollout, setting.policy.get());
  reference->compareNumber("J", cost.evaluate(setting.policy_parameters), tolerance);
  compareStates(reference, cost.states(), tolerance);
  const Eigen::Index count = static_cast<Eigen::Index>(cost.states().size());
  Eigen::VectorXd expected(count), deviation(count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const Gaussian& state = cost.states()[static_cast<std::size_t>(t)];
    expected[t] = rollout.cost.expected(state);
    deviation[t] = std::sqrt(rollout.cost.variance(state));
  }
  reference->compareVector("cost_per_step_0_to_H", expected, tolerance);
  reference->compareVector("cost_std_per_step_0_to_H", deviation, tolerance);
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
