// Receding-horizon policy in feature space: the paper's MPC on images.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/mpc_policy.h"

#include <ddm_model/per_motor.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

/// The model, if plans can be made with it.
std::shared_ptr<const Ddm> usable(std::shared_ptr<const Ddm> model, const MpcOptions& options) {
  if (!within(options.max_torque, model->options().max_torque)) {
    throw std::invalid_argument("mpc/max_torque must be at most the model's model/max_torque " +
                                limitsText(model->options().max_torque) + " N m, got " +
                                limitsText(options.max_torque) +
                                ": lower it, or train a model for larger torques from the bags");
  }
  return model;
}

std::optional<TimeToGoal> timeToGoal(const Ddm& model, const MpcOptions& options) {
  if (options.cost != "time") return std::nullopt;
  if (model.torqueDim() > TimeToGoal::kMaxMotors) {
    throw std::invalid_argument("mpc/cost time needs a model with at most " +
                                std::to_string(TimeToGoal::kMaxMotors) +
                                " motors, as it compares 3^motors sets of torques, got " +
                                std::to_string(model.torqueDim()) + ": set mpc/cost to distance");
  }
  if (model.info().landmarks.cols() < 2) {
    throw std::invalid_argument(
        "mpc/cost time needs a model with landmarks, and this one, of an older version, has none: "
        "train it "
        "again from its bags, or set mpc/cost to distance");
  }
  return TimeToGoal(model, perMotor(options.max_torque, model.torqueDim(), "mpc/max_torque"));
}

}  // namespace

MpcPolicy::MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options)
    : model_(usable(std::move(model), options)),
      offset_gain_(options.offset_gain),
      time_budget_(options.time_budget),
      z_ref_(model_->hasGoal() ? model_->goalFeature() : Eigen::VectorXd()),
      x_(model_->options().memory(), model_->featureDim(), model_->torqueDim()),
      offset_(Eigen::VectorXd::Zero(model_->featureDim())),
      cost_(*model_, options.horizon, options.control_weight, timeToGoal(*model_, options)),
      planner_(&cost_, options) {
  if (hasGoal()) cost_.setGoal(z_ref_);
}

void MpcPolicy::startTrial(const TrialId& id) {
  x_.clear();
  offset_.setZero();
  predicted_.resize(0);
  planner_.clear();
  rng_ = randomStream(id, StreamRole::kPlannerStarts);
}

void MpcPolicy::startSegment() {
  x_.clear();
  predicted_.resize(0);
}

void MpcPolicy::observe(const Grey& grey) {
  began_ = arrival_.value_or(std::chrono::steady_clock::now());
  arrival_.reset();
  const Eigen::VectorXd z = model_->encode(grey);
  if (predicted_.size() > 0) offset_ += offset_gain_ * (z - predicted_ - offset_);
  x_.observe(z);
}

std::optional<double> MpcPolicy::goalDistance() const {
  const double spread = model_->info().feature_spread;
  if (!hasGoal() || !(spread > 0.0) || !std::isfinite(spread)) return std::nullopt;
  const Eigen::VectorXd z = x_.features().col(0);
  return (z - z_ref_).norm() / spread;
}

Plan MpcPolicy::plan() {
  if (!hasGoal()) throw std::logic_error("there is no goal image to plan to");
  const auto begin = std::chrono::steady_clock::now();
  cost_.setProblem(x_, z_ref_, offset_);  // after another goal, computes V
  std::function<bool()> stop = stop_;
  if (time_budget_.count() > 0.0) {
    stop = [this] {
      return std::chrono::steady_clock::now() - began_ >= time_budget_ || (stop_ && stop_());
    };
  }
  Plan plan = planner_.solve(&rng_, stop);
  plan.solve_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return plan;
}

void MpcPolicy::apply(const Eigen::VectorXd& u) {
  if (offset_gain_ > 0.0) predicted_ = model_->predict(x_, u);
  x_.apply(u);
}

}  // namespace ddm
