// Prediction of the state under a policy, and the long-term cost of the policy with its gradient.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pilco/gp_moments.h"
#include "pilco/policy.h"
#include "pilco/state_cost.h"

namespace ddm::pilco {

/// p(x_t) = N(m, s)  ->  p(x_{t+1}) (Deisenroth, Fox and Rasmussen, 2015, Sec. 3.2):
///
///   f = features of x (all entries that are not angles, then sine and cosine of each angle)
///   u = policy(f), or policy(features of x + measurement noise)
///   delta = GP([f, u]);   m' = m + M,   s' = s + cov(x, delta) + cov(delta, x) + S
///
/// with cov(x, delta) = s G_f (V_f + G_u V_u). G_f and G_u are the gains of features and policy;
/// V_f and V_u are the rows of the GP's gain that belong to f and u. No process noise is added.
class Propagation {
 public:
  /// Intermediate results of step() that backward() needs.
  struct Tape {
    Gaussian state;
    Moments features;
    Gaussian policy_input;
    Moments control;
    Moments delta;
    GpMoments::Tape dynamics;
  };

  /// @param dynamics            GP with inputs [f, u]; output a is the change of state entry a
  /// @param angles              entries of the state that are angles [rad]
  /// @param noisy_policy_input  whether the policy sees a noisy measurement of the state. If so,
  ///                            half the noise variance of each output of the GP is added to the
  ///                            variance of the state at the input of the policy. It is half,
  ///                            because the GP learned the noise from differences of two
  ///                            measurements
  Propagation(GpModel dynamics, const std::vector<int>& angles, bool noisy_policy_input);

  int stateDim() const { return state_dim_; }
  int featureDim() const { return features_.outputDim(); }
  int controlDim() const { return dynamics_.model().inputDim() - featureDim(); }

  /// @param state  p(x_t)
  /// @param tape   (optional) out: record for backward()
  Gaussian step(const RbfPolicy& policy, const Gaussian& state, Tape* tape = nullptr) const;

  /// Vector-Jacobian product of step(), exact.
  /// @pre the result of step() was finite
  /// @param d_next        dJ/dm', dJ/ds'
  /// @param d_parameters  dJ/d(parameters of the policy) is ADDED to it
  /// @return              dJ/dm, dJ/ds (symmetric)
  Gaussian backward(const RbfPolicy& policy, const Tape& tape, const Gaussian& d_next,
                    Eigen::VectorXd* d_parameters) const;

 private:
  Gaussian policyState(const Gaussian& state) const;

  int state_dim_;
  Augmentation features_;
  GpMoments dynamics_;
  bool noisy_policy_input_;
  Eigen::VectorXd measurement_variance_;  // variance added at the input of the policy [D]
};

/// J(theta) = sum_{t=1..H} E[c(x_t)] (Deisenroth and Rasmussen, 2011). The cost of the given x_0 is
/// not included. The gradient is computed backwards through the steps.
class LongTermCost {
 public:
  /// @param dynamics       prediction of one step
  /// @param cost           c
  /// @param policy         must outlive this object; evaluate() sets its parameters
  /// @param initial_state  p(x_0), finite
  /// @param horizon        H >= 1, number of steps
  LongTermCost(Propagation dynamics, StateCost cost, RbfPolicy* policy, Gaussian initial_state,
               int horizon);

  /// @param parameters  theta, the parameters of the policy
  /// @param gradient    (optional) out: dJ/d theta
  /// @return            J; NaN, with a gradient of NaN, if a prediction is not finite
  double evaluate(const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient = nullptr);

  /// p(x_0) ... p(x_H) of the latest evaluate(); fewer than H + 1 if its result was NaN.
  const std::vector<Gaussian>& states() const { return states_; }

  /// E[c(x_1)] ... E[c(x_H)] of the latest evaluate(), one for each predicted state.
  const std::vector<double>& costs() const { return costs_; }

  /// Standard deviations of c(x_1) ... c(x_H) of the latest evaluate().
  std::vector<double> costStandardDeviations() const;

 private:
  Propagation dynamics_;
  StateCost cost_;
  RbfPolicy* policy_;
  int horizon_;
  std::vector<Gaussian> states_;
  std::vector<double> costs_;
};

}  // namespace ddm::pilco
