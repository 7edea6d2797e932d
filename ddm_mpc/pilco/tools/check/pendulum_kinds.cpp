// pilco_check: one step of the pendulum and of its predicted state, its long-term cost.
// SPDX-License-Identifier: BSD-3-Clause
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "check/case.h"
#include "ddm_pilco/long_term_cost.h"

namespace ddm::pilco::check {
namespace {

constexpr Tolerance kState = absolute(1e-9);
constexpr int kStateDim = 2;    // of the pendulum: angular velocity, angle
constexpr int kFeatureDim = 3;  // angular velocity, sine, cosine

/// What the two published versions of the pendulum scenario have fixed.
struct Scenario {
  double gravity;           ///< [m / s^2]
  double friction;          ///< [N m s / rad]
  double time_step;         ///< [s]
  bool noisy_policy_input;  ///< see PropagationOptions
};

/// That of the field `scenario`.
Scenario readScenario(Case* reference) {
  const std::string name = reference->text("scenario");
  if (name == "a0b48b7") return {9.82, 0.01, 0.1, false};
  Case::require(name == "f9707a9", "scenario", "must be a0b48b7 or f9707a9, got " + name);
  return {0.0, 1.0, 0.2, true};
}

/// What the predictions of the pendulum's state consist of.
struct Setting {
  GpData data;
  PropagationOptions options;
  std::unique_ptr<SquashedPolicy> policy;
};

Setting readSetting(Case* reference) {
  Setting setting;
  setting.options.angles = {1};
  setting.options.noisy_policy_input = readScenario(reference).noisy_policy_input;
  const std::string noise_added = setting.options.noisy_policy_input ? "true" : "false";
  Case::require(reference->text("policy_input_noise_added") == noise_added,
                "policy_input_noise_added", "must be " + noise_added + " in this scenario");
  setting.data = readGpData(reference);
  setting.policy = std::make_unique<SquashedPolicy>(readRbfPolicy(reference, kFeatureDim, 1),
                                                    reference->vector("maxU", 1));
  return setting;
}

LongTermCost readLongTermCost(Case* reference, const Setting& setting) {
  reference->compare("target", Eigen::Vector2d(0.0, M_PI), kClosedForm);
  const Eigen::Index horizon = reference->matrix("means_0_to_H").rows() - 1;
  reference->requireCount("H", horizon);
  return LongTermCost(Propagation(readModel(reference, setting.data), setting.options),
                      pendulumCost(1.0, reference->number("width")), setting.policy.get(),
                      reference->gaussian("m0", "s0", kStateDim), static_cast<int>(horizon));
}

/// Means and covariances for t = 0 ... H.
void compareStates(Case* reference, const std::vector<Gaussian>& states, Tolerance tolerance) {
  Eigen::MatrixXd means(states.size(), kStateDim), covariances(states.size(), 3);
  for (std::size_t t = 0; t < states.size(); ++t) {
    const Eigen::MatrixXd& s = states[t].covariance;
    means.row(static_cast<Eigen::Index>(t)) = states[t].mean.transpose();
    covariances.row(static_cast<Eigen::Index>(t)) << s(0, 0), s(1, 1), s(0, 1);
  }
  reference->compare("means_0_to_H", means, tolerance);
  reference->compare("var_dphi_0_to_H", covariances.col(0), tolerance);
  reference->compare("var_phi_0_to_H", covariances.col(1), tolerance);
  reference->compare("cov_dphi_phi_0_to_H", covariances.col(2), tolerance);
}

/// dJ/d parameters by central differences of fourth order with this step.
Eigen::VectorXd differenceGradient(LongTermCost* cost, const Eigen::VectorXd& parameters,
                                   double step) {
  Eigen::VectorXd gradient(parameters.size());
  for (Eigen::Index i = 0; i < parameters.size(); ++i) {
    const auto at = [&](double change) {
      Eigen::VectorXd changed = parameters;
      changed[i] += change;
      return cost->evaluate(changed);
    };
    gradient[i] =
        (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
  }
  return gradient;
}

}  // namespace

void checkSimulation(Case* reference) {
  const Scenario scenario = readScenario(reference);
  reference->compare("dt", scenario.time_step, kClosedForm);
  const Eigen::VectorXd start = reference->vector("x0", kStateDim);
  const double torque = reference->number("u");
  // State [rate, angle]; mass and length are 1, and so the moment of inertia is 1/3.
  using State = std::vector<double>;
  const auto ode = [&scenario, torque](const State& x, State& dx, double) {
    dx[0] = 3.0 * (torque - scenario.friction * x[0] - 0.5 * scenario.gravity * std::sin(x[1]));
    dx[1] = x[0];
  };
  namespace odeint = boost::numeric::odeint;
  State x = {start[0], start[1]};
  odeint::integrate_adaptive(
      odeint::make_controlled(1e-13, 1e-13, odeint::runge_kutta_dopri5<State>()), ode, x, 0.0,
      scenario.time_step, 0.01 * scenario.time_step);
  reference->compare("x1", Eigen::Vector2d(x[0], x[1]), kState);
}

void checkPropagation(Case* reference) {
  const Setting setting = readSetting(reference);
  Propagation propagation(readModel(reference, setting.data), setting.options);
  Propagation::Tape tape;
  const Gaussian next =
      propagation.step(setting.policy.get(), reference->gaussian("m", "s", kStateDim), &tape);
  reference->compare("m_next", next.mean, kState);
  reference->compare("s_next", next.covariance, kState);
  compareJacobians(reference, {{"M", relative(1e-9)}, {"S", relative(1e-9)}}, "s", kStateDim,
                   kStateDim, [&](const Moments& seed) {
                     return propagation.backward(setting.policy.get(), tape,
                                                 Gaussian{seed.mean, seed.covariance}, nullptr);
                   });
}

void checkValue(Case* reference) {
  constexpr Tolerance kGradient = relative(1e-6);
  Setting setting = readSetting(reference);
  const Eigen::VectorXd parameters = setting.policy->parameters();
  LongTermCost cost = readLongTermCost(reference, setting);
  Eigen::VectorXd exact;
  reference->compare("J", cost.evaluate(parameters, &exact), kState);
  reference->compare("cost_per_step_1_to_H",
                     Eigen::Map<const Eigen::VectorXd>(
                         cost.costs().data(), static_cast<Eigen::Index>(cost.costs().size())),
                     kState);
  compareStates(reference, cost.states(), kState);

  // The differences of the file have truncation errors of their own, beyond the tolerance where J
  // bends much. So like is compared with like, and the exact gradient with finer differences.
  const auto compare = [&](const std::string& field, const Eigen::VectorXd& computed) {
    reference->compareRead(field, readParameters(reference, kFeatureDim, 1, field + "/"), computed,
                           kGradient);
  };
  compare("grad_finite_difference", differenceGradient(&cost, parameters, 1e-3));
  reference->compareRead("finer differences than grad_finite_difference",
                         differenceGradient(&cost, parameters, 1e-4), exact, kGradient);

  setting.options.published_gradient = true;
  Eigen::VectorXd published;
  readLongTermCost(reference, setting).evaluate(parameters, &published);
  compare("grad_as_implemented", published);
}

void checkAuthors(Case* reference) {
  const Tolerance tolerance = relative(1e-5);
  const Setting setting = readSetting(reference);
  reference->requireCount("n", setting.data.inputs.cols());
  const GpFit fit = trainFromStart(reference, setting.data);
  reference->compare("loghyp", toMatrix(fit.model.hyperparameters), tolerance);
  reference->compare("nlml_curb", Eigen::Vector2d(fit.outputs[0].cost, fit.outputs[1].cost),
                     tolerance);

  LongTermCost cost = readLongTermCost(reference, setting);
  reference->compare("J", cost.evaluate(setting.policy->parameters()), tolerance);
  compareStates(reference, cost.states(), tolerance);
  const StateCost per_step = pendulumCost(1.0, reference->number("width"));
  Eigen::MatrixXd costs(cost.states().size(), 2);
  for (std::size_t t = 0; t < cost.states().size(); ++t) {
    const Gaussian& state = cost.states()[t];
    costs.row(static_cast<Eigen::Index>(t)) << per_step.expected(state),
        std::sqrt(per_step.variance(state));
  }
  reference->compare("cost_per_step_0_to_H", costs.col(0), tolerance);
  reference->compare("cost_std_per_step_0_to_H", costs.col(1), tolerance);
}

}  // namespace ddm::pilco::check
