// pilco_check: expected saturating costs.
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "check/jacobian.h"
#include "check/kinds.h"
#include "ddm_pilco/saturating_cost.h"
#include "ddm_pilco/state_cost.h"

namespace ddm {
namespace pilco {
namespace check {
namespace {

constexpr Tolerance kCost = absolute(1e-12);

template <class Cost>
void compareCost(Case* reference, const Cost& cost) {
  const int dim = cost.inputDim();
  const Gaussian input = {reference->vector("m", dim), reference->covariance("s", dim)};
  Gaussian d_input;
  reference->compareNumber("L", cost.expected(input, &d_input), kCost);
  reference->compareNumber("var", cost.variance(input), kCost);
  reference->compareVector("dLdm", d_input.mean, kCost);
  const Eigen::MatrixXd d_covariance = reference->matrix("dLds", dim, dim);
  reference->compare("dLds", 0.5 * (d_covariance + d_covariance.transpose()), d_input.covariance,
                     kCost);
}

}  // namespace

void checkSaturatingCost(Case* reference) {
  const Eigen::VectorXd target = reference->vector("z");
  reference->requireCount("D", target.size());
  compareCost(reference, SaturatingCost(target, reference->covariance("W", target.size())));
}

void checkPendulumCost(Case* reference) {
  reference->compareVector("target", Eigen::Vector2d(0.0, M_PI), kCost);
  compareCost(reference, pendulumCost(reference->number("length"), reference->number("width")));
}

}  // namespace check
}  // namespace pilco
}  // namespace ddm
