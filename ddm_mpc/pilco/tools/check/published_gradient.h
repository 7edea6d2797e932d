// pilco_check: gradients of the long-term cost as the published program and the files have them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "ddm_pilco/long_term_cost.h"
#include "ddm_pilco/policy.h"
#include "ddm_pilco/propagation.h"
#include "ddm_pilco/state_cost.h"

namespace ddm {
namespace pilco {
namespace check {

/// Everything that J depends on but the policy.
struct Rollout {
  GpModel dynamics;
  PropagationOptions options;
  StateCost cost;
  Gaussian initial_state;
  int horizon;
};

/// dJ/d parameters, in which the features that the policy sees are differentiated as if the
/// measurement noise were not there. Exact, and the same as LongTermCost, without that noise.
/// @param policy  with its parameters set
Eigen::VectorXd publishedGradient(const Rollout& rollout, Policy* policy);

/// dJ/d parameters by central differences of fourth order with this step.
Eigen::VectorXd differenceGradient(LongTermCost* cost, const Eigen::VectorXd& parameters,
                                   double step);

}  // namespace check
}  // namespace pilco
}  // namespace ddm
