// Long-term cost J of a policy under the learned dynamics, with its exact gradient.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_pilco/long_term_cost.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ddm_pilco/messages.h"

namespace ddm::pilco {

LongTermCost::LongTermCost(Propagation dynamics, StateCost cost, Policy* policy,
                           Gaussian initial_state, int horizon)
    : dynamics_(std::move(dynamics)),
      cost_(std::move(cost)),
      policy_(policy),
      horizon_(horizon),
      states_{std::move(initial_state)} {
  require(horizon >= 1, "long-term cost: the horizon must be >= 1, got ", horizon);
  require(policy != nullptr, "long-term cost: a policy is missing");
  dynamics_.requireFit(*policy);
  require(cost_.inputDim() == dynamics_.stateDim(),
          "long-term cost: the cost must be for a state of ", dynamics_.stateDim(),
          " entries, got one for ", cost_.inputDim());
  const Gaussian& start = states_.front();
  requireSize(start, dynamics_.stateDim(), "long-term cost");
  require(start.mean.allFinite() && start.covariance.allFinite(),
          "long-term cost: the initial state must be finite, got mean [", start.mean.transpose(),
          "] and variances [", start.covariance.diagonal().transpose(), "]");
}

/// False where the prediction leaves the finite numbers.
bool LongTermCost::predict(bool record) {
  states_.resize(1);
  costs_.clear();
  if (record) tapes_.resize(horizon_);
  for (int t = 0; t < horizon_; ++t) {
    states_.push_back(dynamics_.step(policy_, states_[t], record ? &tapes_[t] : nullptr));
    costs_.push_back(cost_.expected(states_.back()));
    if (!states_.back().mean.allFinite() || !states_.back().covariance.allFinite() ||
        !std::isfinite(costs_.back())) {
      states_.pop_back();
      costs_.pop_back();
      return false;
    }
  }
  return true;
}

double LongTermCost::evaluate(const Eigen::VectorXd& parameters, Eigen::VectorXd* gradient) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  policy_->setParameters(parameters);
  const bool finite = predict(gradient != nullptr);
  if (gradient != nullptr) {
    *gradient = Eigen::VectorXd::Constant(parameters.size(), finite ? 0.0 : kNaN);
  }
  if (!finite) return kNaN;
  double total = 0.0;
  for (const double cost : costs_) total += cost;
  if (gradient == nullptr) return total;

  Gaussian d_state = constantGaussian(dynamics_.stateDim());
  for (int t = horizon_; t > 0; --t) {
    Gaussian d_cost;
    cost_.expected(states_[t], &d_cost);
    d_state.mean += d_cost.mean;
    d_state.covariance += d_cost.covariance;
    d_state = dynamics_.backward(policy_, tapes_[t - 1], d_state, gradient);
  }
  return total;
}

std::vector<double> LongTermCost::costStandardDeviations() const {
  std::vector<double> out;
  for (std::size_t t = 1; t < states_.size(); ++t) {
    out.push_back(std::sqrt(std::max(0.0, cost_.variance(states_[t]))));  // rounded below 0
  }
  return out;
}

}  // namespace ddm::pilco
