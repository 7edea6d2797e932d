// Receding-horizon policy in feature space: the paper's MPC on images.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_policy.h"

#include <ddm_model/per_motor.h>

#include <cmath>
#include <stdexcept>

#include "ddm_mpc/random_stream.h"

namespace ddm {

namespace {

bool knowsSpread(const Ddm& model) {
  return model.info().feature_spread > 0.0 && std::isfinite(model.info().feature_spread);
}

DistanceCost distanceCost(const Ddm& model, const MpcOptions& options) {
  if (options.scale_distance && !knowsSpread(model)) {
    throw std::invalid_argument(
        "mpc/scale_distance needs a model that knows the spread of its features: train it again");
  }
  DistanceCost cost;
  if (options.scale_distance) cost.scale = model.info().feature_spread;
  cost.width = options.saturation_width;
  cost.terminal_weight = options.terminal_weight;
  return cost;
}

}  // namespace

MpcPolicy::Member::Member(const Ddm& of_model, const MpcOptions& options)
    : model(of_model),
      x(model.options().order, model.featureDim(), model.torqueDim()),
      cost(model, options.horizon, options.control_weight, distanceCost(model, options)),
      offset_gain(options.offset_gain),
      offset(Eigen::VectorXd::Zero(model.featureDim())) {
  if (!model.hasGoal()) {
    throw std::invalid_argument("the model has no goal image to plan to: train it with one");
  }
  if (!within(options.max_torque, model.options().max_torque)) {
    throw std::invalid_argument("mpc/max_torque must be at most the model's model/max_torque " +
                                limitsText(model.options().max_torque) + " N m, got " +
                                limitsText(options.max_torque) +
                                ": the model has seen no larger torque");
  }
}

void MpcPolicy::Member::startTrial() {
  x.clear();
  offset.setZero();
  predicted.resize(0);
}

void MpcPolicy::Member::observe(const Grey& grey) {
  const Eigen::VectorXd z = model.encode(grey);
  if (predicted.size() > 0) offset += offset_gain * (z - predicted - offset);
  x.observe(z);
}

void MpcPolicy::Member::apply(const Eigen::VectorXd& u) {
  if (offset_gain > 0.0) predicted = model.predict(x, u);
  x.apply(u);
}

MpcPolicy::MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options)
    : model_(std::move(model)),
      disagreement_bonus_(options.disagreement_bonus),
      time_budget_(options.time_budget),
      members_(makeMembers(*model_, options)),
      cost_(costsOf(members_)),
      planner_(&cost_, options) {}

std::vector<std::unique_ptr<MpcPolicy::Member>> MpcPolicy::makeMembers(const Ddm& model,
                                                                       const MpcOptions& options) {
  std::vector<std::unique_ptr<Member>> members;
  members.push_back(std::make_unique<Member>(model, options));
  for (const Ddm& other : model.others()) {
    members.push_back(std::make_unique<Member>(other, options));
  }
  return members;
}

std::vector<PlanCost*> MpcPolicy::costsOf(const std::vector<std::unique_ptr<Member>>& members) {
  std::vector<PlanCost*> costs;
  for (const auto& member : members) costs.push_back(&member->cost);
  return costs;
}

void MpcPolicy::setHorizon(int horizon) {
  for (const auto& member : members_) member->cost.setHorizon(horizon);
}

void MpcPolicy::setControlWeight(double control_weight) {
  for (const auto& member : members_) member->cost.setControlWeight(control_weight);
}

void MpcPolicy::startTrial(const TrialId& id) {
  for (const auto& member : members_) member->startTrial();
  cost_.setBonus(id.evaluation ? 0.0 : disagreement_bonus_);
  planner_.clear();
  rng_ = randomStream(id, StreamRole::kPlannerStarts);
}

void MpcPolicy::observe(const Grey& grey) {
  began_ = arrival_.value_or(std::chrono::steady_clock::now());
  arrival_.reset();
  for (const auto& member : members_) member->observe(grey);
}

std::optional<double> MpcPolicy::goalDistance() const {
  if (!knowsSpread(*model_)) return std::nullopt;
  const Eigen::VectorXd z = members_.front()->x.features().col(0);
  return (z - model_->goalFeature()).norm() / model_->info().feature_spread;
}

Plan MpcPolicy::plan() {
  for (const auto& member : members_) {
    member->cost.setProblem(member->x, member->model.goalFeature(), member->offset);
  }
  if (time_budget_.count() <= 0.0) return planner_.solve(&rng_, stop_);
  return planner_.solve(&rng_, [this] {
    return std::chrono::steady_clock::now() - began_ >= time_budget_ || (stop_ && stop_());
  });
}

void MpcPolicy::apply(const Eigen::VectorXd& u) {
  for (const auto& member : members_) member->apply(u);
}

}  // namespace ddm
