// pilco_check: gradients of the long-term cost as the published program and the files have them.
// SPDX-License-Identifier: BSD-3-Clause
#include "check/published_gradient.h"

#include <vector>

namespace ddm {
namespace pilco {
namespace check {
namespace {

/// Passes everything on and remembers what the last backward() returned.
class RecordingPolicy : public Policy {
 public:
  explicit RecordingPolicy(Policy* policy) : policy_(*policy) {}

  int inputDim() const override { return policy_.inputDim(); }
  int outputDim() const override { return policy_.outputDim(); }
  Eigen::VectorXd parameters() const override { return policy_.parameters(); }
  void setParameters(const Eigen::VectorXd& p) override { policy_.setParameters(p); }
  Moments predict(const Gaussian& input) override { return policy_.predict(input); }
  Gaussian backward(const Gaussian& input, const Moments& d_output,
                    Eigen::VectorXd* d_parameters) override {
    last_ = policy_.backward(input, d_output, d_parameters);
    return last_;
  }
  const Gaussian& last() const { return last_; }

 private:
  Policy& policy_;
  Gaussian last_;
};

void add(const Gaussian& part, double factor, Gaussian* sum) {
  sum->mean += factor * part.mean;
  sum->covariance += factor * part.covariance;
}

}  // namespace

Eigen::VectorXd publishedGradient(const Rollout& rollout, Policy* policy) {
  Propagation propagation(rollout.dynamics, rollout.options);
  RecordingPolicy recording(policy);
  std::vector<Propagation::Tape> tapes(static_cast<std::size_t>(rollout.horizon));
  Gaussian state = rollout.initial_state;
  std::vector<Gaussian> d_costs;
  for (Propagation::Tape& tape : tapes) {
    state = propagation.step(&recording, state, &tape);
    Gaussian d_cost;
    rollout.cost.expected(state, &d_cost);
    d_costs.push_back(d_cost);
  }

  const int dim = propagation.stateDim();
  const Eigen::VectorXd noise_variance =
      0.5 * (2.0 * rollout.dynamics.hyperparameters.log_noise_std.array()).exp();
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(policy->numParameters());
  Gaussian d_state = constantGaussian(dim);
  for (std::size_t t = tapes.size(); t-- > 0;) {
    add(d_costs[t], 1.0, &d_state);
    d_state = propagation.backward(&recording, tapes[t], d_state, &gradient);
    if (!rollout.options.noisy_policy_input) continue;
    Moments d_features = constantMoments(dim, propagation.featureDim());
    d_features.mean = recording.last().mean;
    d_features.covariance = recording.last().covariance;
    Gaussian measured = tapes[t].state;
    add(propagation.features().backward(measured, d_features), 1.0, &d_state);
    measured.covariance.diagonal() += noise_variance;
    add(propagation.features().backward(measured, d_features), -1.0, &d_state);
  }
  return gradient;
}

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

}  // namespace check
}  // namespace pilco
}  // namespace ddm
