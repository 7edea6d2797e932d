// Long-term cost J of a policy under the learned dynamics, with its exact gradient.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "ddm_pilco/policy.h"
#include "ddm_pilco/propagation.h"
#include "ddm_pilco/state_cost.h"

namespace ddm::pilco {

/// J(theta) = sum_{t=1..H} E[c(x_t)] (Deisenroth and Rasmussen, 2011). x_0 is given and not
/// counted. The gradient goes backwards through the steps.
class LongTermCost {
 public:
  /// @param dynamics       one step
  /// @param cost           c
  /// @param policy         with bounded controls; evaluate() sets its parameters; outlives this
  /// @param initial_state  p(x_0)
  /// @param horizon        H, steps
  /// @throws std::invalid_argument if sizes do not fit, horizon < 1, or the initial state is not
  ///         finite
  LongTermCost(Propagation dynamics, StateCost cost, Policy* policy, Gaussian initial_state,
               int horizon);

  /// @param parameters  theta, of the policy
  /// @param gradient    (optional) out: dJ/d theta
  /// @return J. NaN, with a gradient of NaN, where the prediction leaves the finite numbers
  /// @throws std::invalid_argument for a wrong number of parameters
  double evaluate(const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient = nullptr);

  /// p(x_0) ... p(x_H) of the last evaluate(): H + 1 of them, or fewer where it ended in NaN.
  const std::vector<Gaussian>& states() const { return states_; }

  /// E[c(x_1)] ... E[c(x_H)] of the last evaluate(), as many as there are predicted states.
  const std::vector<double>& costs() const { return costs_; }

  /// Standard deviation of c(x_1) ... c(x_H) of the last evaluate().
  std::vector<double> costStandardDeviations() const;

 private:
  bool predict(bool record);

  Propagation dynamics_;
  StateCost cost_;
  Policy* policy_;
  int horizon_;
  std::vector<Gaussian> states_;
  std::vector<double> costs_;
  std::vector<Propagation::Tape> tapes_;
};

}  // namespace ddm::pilco
