// Receding-horizon policy in feature space: the paper's MPC on images.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_policy.h"

#include <sstream>
#include <stdexcept>

#include "ddm_mpc/random_stream.h"

namespace ddm {

MpcPolicy::MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options)
    : model_(std::move(model)),
      x_(model_->options().order, model_->featureDim(), model_->torqueDim()),
      cost_(*model_, options.horizon, options.control_weight),
      planner_(&cost_, options) {
  if (!model_->hasGoal()) {
    throw std::invalid_argument("the model has no goal image to plan to: train it with one");
  }
  if (options.max_torque > model_->options().max_torque) {
    std::ostringstream text;
    text << "mpc/max_torque must be at most the model's model/max_torque "
         << model_->options().max_torque << " N m, got " << options.max_torque
         << ": the model has seen no larger torque";
    throw std::invalid_argument(text.str());
  }
}

void MpcPolicy::startTrial(const TrialId& id) {
  x_.clear();
  planner_.clear();
  rng_ = randomStream(id, StreamRole::kPlannerStarts);
}

void MpcPolicy::observe(const Grey& grey) { x_.observe(model_->encode(grey)); }

Plan MpcPolicy::plan() {
  cost_.setProblem(x_, model_->goalFeature());
  return planner_.solve(&rng_);
}

void MpcPolicy::apply(const Eigen::VectorXd& u) { x_.apply(u); }

}  // namespace ddm
