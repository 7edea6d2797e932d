// Prediction of the state under a policy, and the long-term cost of the policy with its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include "pilco/long_term_cost.h"

#include <cmath>
#include <utility>

namespace ddm::pilco {
namespace {

/// N([f, u]) from the moments of f and the moments of u = policy(f).
Gaussian joint(const Moments& features, const Moments& control) {
  const Eigen::MatrixXd cross = features.covariance * control.gain;
  Gaussian both = constantGaussian(static_cast<int>(features.mean.size() + control.mean.size()));
  both.mean << features.mean, control.mean;
  both.covariance << features.covariance, cross, cross.transpose(), control.covariance;
  return both;
}

void add(const Gaussian& part, Gaussian* sum) {
  sum->mean += part.mean;
  sum->covariance += part.covariance;
}

}  // namespace

Propagation::Propagation(GpModel dynamics, const std::vector<int>& angles, bool noisy_policy_input)
    : state_dim_(dynamics.outputDim()),
      features_(replaceAngles(state_dim_, angles)),
      dynamics_(std::move(dynamics)),
      noisy_policy_input_(noisy_policy_input) {
  eigen_assert(controlDim() >= 1);
  const GpModel& model = dynamics_.model();
  const Eigen::VectorXd log_noise_std = model.hyperparameters.row(model.inputDim() + 1).transpose();
  measurement_variance_ = 0.5 * (2.0 * log_noise_std.array()).exp();
}

/// Distribution of the measured state, on which the policy acts.
Gaussian Propagation::policyState(const Gaussian& state) const {
  Gaussian measured = state;
  measured.covariance.diagonal() += measurement_variance_;
  return measured;
}

Gaussian Propagation::step(const RbfPolicy& policy, const Gaussian& state, Tape* tape) const {
  eigen_assert(policy.inputDim() == featureDim() && policy.outputDim() == controlDim());
  const Moments features = features_.predict(state);
  const Gaussian policy_input =
      marginal(noisy_policy_input_ ? features_.predict(policyState(state)) : features);
  const Moments control = policy.predict(policy_input);
  const Moments delta =
      dynamics_.predict(joint(features, control), tape != nullptr ? &tape->dynamics : nullptr);

  const Eigen::MatrixXd gain =
      delta.gain.topRows(featureDim()) + control.gain * delta.gain.bottomRows(controlDim());
  const Eigen::MatrixXd cross = state.covariance * (features.gain * gain);
  if (tape != nullptr) {
    *tape = {state, features, policy_input, control, delta, std::move(tape->dynamics)};
  }
  return Gaussian{state.mean + delta.mean,
                  symmetricPart(state.covariance + cross + cross.transpose() + delta.covariance)};
}

Gaussian Propagation::backward(const RbfPolicy& policy, const Tape& tape, const Gaussian& d_next,
                               Eigen::VectorXd* d_parameters) const {
  const int num_features = featureDim();
  const int num_controls = controlDim();
  const Eigen::MatrixXd& s = tape.state.covariance;
  const Eigen::MatrixXd& feature_gain = tape.features.gain;
  const auto gain_u = tape.delta.gain.bottomRows(num_controls);
  const Eigen::MatrixXd gain = tape.delta.gain.topRows(num_features) + tape.control.gain * gain_u;
  const Eigen::MatrixXd d_covariance = symmetricPart(d_next.covariance);

  // s' = s + X + X^T + S with X = s G_f (V_f + G_u V_u)
  const Eigen::MatrixXd d_cross = 2.0 * d_covariance;
  Gaussian d_state{d_next.mean, d_covariance + d_cross * (feature_gain * gain).transpose()};
  Moments d_features = constantMoments(state_dim_, num_features);
  d_features.gain = s * d_cross * gain.transpose();
  const Eigen::MatrixXd d_gain = feature_gain.transpose() * s * d_cross;

  Moments d_delta{d_next.mean, d_covariance, Eigen::MatrixXd(tape.delta.gain.rows(), state_dim_)};
  d_delta.gain << d_gain, tape.control.gain.transpose() * d_gain;
  const Gaussian d_joint = dynamics_.backward(tape.dynamics, d_delta);

  // joint covariance: [F, F G_u; (F G_u)^T, S_u]
  const Eigen::MatrixXd d_fu = 2.0 * d_joint.covariance.topRightCorner(num_features, num_controls);
  const Moments d_control{d_joint.mean.tail(num_controls),
                          d_joint.covariance.bottomRightCorner(num_controls, num_controls),
                          d_gain * gain_u.transpose() + tape.features.covariance * d_fu};
  d_features.mean = d_joint.mean.head(num_features);
  d_features.covariance = d_joint.covariance.topLeftCorner(num_features, num_features) +
                          d_fu * tape.control.gain.transpose();

  const Gaussian d_policy_input = policy.backward(tape.policy_input, d_control, d_parameters);
  if (noisy_policy_input_) {
    add(features_.backward(policyState(tape.state),
                           Moments{d_policy_input.mean, d_policy_input.covariance,
                                   Eigen::MatrixXd::Zero(state_dim_, num_features)}),
        &d_state);
  } else {
    d_features.mean += d_policy_input.mean;
    d_features.covariance += d_policy_input.covariance;
  }
  add(features_.backward(tape.state, d_features), &d_state);
  d_state.covariance = symmetricPart(d_state.covariance);
  return d_state;
}

LongTermCost::LongTermCost(Propagation dynamics, StateCost cost, RbfPolicy* policy,
                           Gaussian initial_state, int horizon)
    : dynamics_(std::move(dynamics)),
      cost_(std::move(cost)),
      policy_(policy),
      horizon_(horizon),
      states_{std::move(initial_state)} {
  eigen_assert(horizon >= 1 && cost_.inputDim() == dynamics_.stateDim());
}

double LongTermCost::evaluate(const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
  policy_->setParameters(parameters);
  if (gradient != nullptr) gradient->setConstant(parameters.size(), kNaN);
  states_.resize(1);
  costs_.clear();
  std::vector<Propagation::Tape> tapes(gradient != nullptr ? horizon_ : 0);
  double total = 0.0;
  for (int t = 0; t < horizon_; ++t) {
    const Gaussian next =
        dynamics_.step(*policy_, states_[t], gradient != nullptr ? &tapes[t] : nullptr);
    const double cost = cost_.expected(next);
    if (!next.mean.allFinite() || !next.covariance.allFinite() || !std::isfinite(cost)) return kNaN;
    states_.push_back(next);
    costs_.push_back(cost);
    total += cost;
  }
  if (gradient == nullptr) return total;

  gradient->setZero();
  Gaussian d_state = constantGaussian(dynamics_.stateDim());
  for (int t = horizon_; t > 0; --t) {
    Gaussian d_cost;
    cost_.expected(states_[t], &d_cost);
    add(d_cost, &d_state);
    d_state = dynamics_.backward(*policy_, tapes[t - 1], d_state, gradient);
  }
  return total;
}

std::vector<double> LongTermCost::costStandardDeviations() const {
  std::vector<double> out;
  for (std::size_t t = 1; t < states_.size(); ++t) {
    out.push_back(std::sqrt(cost_.variance(states_[t])));
  }
  return out;
}

}  // namespace ddm::pilco
