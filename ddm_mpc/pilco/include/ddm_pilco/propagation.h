// One step of the state distribution under dynamics GP and policy, with derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "ddm_pilco/gp_moments.h"
#include "ddm_pilco/policy.h"
#include "ddm_pilco/trigonometric.h"

namespace ddm::pilco {

/// What the state means to the dynamics GP and the policy.
struct PropagationOptions {
  std::vector<int> angles;  ///< entries of the state that are angles [rad]
  /// The policy sees a measurement of the state: half the noise variance of each output of the GP
  /// is added to the state's variance at the input of the policy. Half, because the GP learned it
  /// from differences of two measurements.
  bool noisy_policy_input = false;
  /// Differentiate as the published program does: what the policy sees as if it had no noise.
  bool published_gradient = false;
};

/// p(x_t) = N(m, s)  ->  p(x_{t+1}) (Deisenroth, Fox and Rasmussen, 2015, Sec. 3.2):
///
///   f = features of x (entries that are no angles, then sine and cosine of each angle)
///   u = policy(f), or policy(features of x + measurement noise)
///   delta = GP([f, u]);   m' = m + M,   s' = s + cov(x, delta) + cov(delta, x) + S
///
/// with cov(x, delta) = s G_f (V_f + G_u V_u): G are gains, V_f and V_u the rows of the GP's gain.
/// No process noise is added.
class Propagation {
 public:
  /// What backward() needs from step().
  struct Tape {
    Gaussian state;
    Moments features;
    Gaussian policy_input;
    Moments control;
    Moments delta;
    GpMoments::Tape dynamics;
  };

  /// @param dynamics  GP with inputs [f, u]; output a is the difference of state entry a
  /// @throws std::invalid_argument if the sizes leave no control, or for angles that do not exist
  Propagation(GpModel dynamics, const PropagationOptions& options);

  int stateDim() const { return state_dim_; }
  int featureDim() const { return features_.outputDim(); }
  int controlDim() const { return dynamics_.model().inputDim() - featureDim(); }
  const Augmentation& features() const { return features_; }

  /// @throws std::invalid_argument unless features and controls are as many as those of the policy
  void requireFit(const Policy& policy) const;

  /// @param policy  with bounded controls
  /// @param state   p(x_t)
  /// @param tape    (optional) out: record for backward()
  /// @throws std::invalid_argument if the sizes of policy or state do not fit
  Gaussian step(Policy* policy, const Gaussian& state, Tape* tape = nullptr);

  /// Vector-Jacobian product of step(), exact, unless published_gradient is asked for.
  /// @param d_next        dJ/dm', dJ/ds'
  /// @param d_parameters  (optional) dJ/d parameters of the policy is ADDED to it
  /// @return              dJ/dm, dJ/ds (symmetric)
  Gaussian backward(Policy* policy, const Tape& tape, const Gaussian& d_next,
                    Eigen::VectorXd* d_parameters) const;

 private:
  Gaussian policyState(const Gaussian& state) const;

  int state_dim_;
  Augmentation features_;
  GpMoments dynamics_;
  PropagationOptions options_;
  Eigen::VectorXd measurement_variance_;  // of what the policy sees, where it is noisy [D]
};

}  // namespace ddm::pilco
