// The controller: MPC on images (paper, Sec. 3.1), and epsilon-greedy exploration (Sec. 3.2).
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/controller.h"

#include <ddm_model/per_motor.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace ddm {

using Clock = std::chrono::steady_clock;

/// One step of Algorithm 1: answers the image y_t with the torque u_t.
Decision EpsilonGreedy::decide(const Image& image) {
  Decision decision;
  if (policy_ != nullptr) {
    if (acted_) policy_->apply(*acted_);
    policy_->observe(image);
    decision.goal_distance = policy_->goalDistance();
  }
  if (held_steps_left_ == 0) drawTorque();
  decision.exploratory = held_steps_left_ > 0;
  if (decision.exploratory) {
    --held_steps_left_;
    decision.torque = held_torque_;
  } else {
    Answer answer = policy_->answer();
    decision.torque = std::move(answer.torque);
    decision.solve_time = answer.solve_time;
    decision.plan = std::move(answer.plan);
  }
  acted_ = decision.torque;
  return decision;
}

/// Draws, with probability epsilon, a random torque and how long it is held (paper, Sec. 3.2).
void EpsilonGreedy::drawTorque() {
  if (std::uniform_real_distribution<double>(0.0, 1.0)(rng_) >= options_.epsilon) return;
  held_torque_.resize(options_.max_torque.size());
  for (Eigen::Index i = 0; i < held_torque_.size(); ++i) {
    const double limit = options_.max_torque[i];
    held_torque_[i] = std::uniform_real_distribution<double>(-limit, limit)(rng_);
  }
  held_steps_left_ = 1;
  if (options_.hold_steps > 1) {  // otherwise nothing is drawn
    held_steps_left_ = std::uniform_int_distribution<int>(1, options_.hold_steps)(rng_);
  }
}

/// Encodes the image, z_t = g^-1(y_t) (eq. 3a), and adds z_t to the controller state x_t (eq. 8).
void MpcPolicy::observe(const Image& image) {
  began_ = arrival_.value_or(Clock::now());
  arrival_.reset();
  const Eigen::VectorXd z = model_->encode(image);
  if (predicted_.size() > 0) offset_ += offset_gain_ * (z - predicted_ - offset_);
  x_.observe(z);
}

/// Minimises J(U) (eq. 9) from x_t on. The first torque of the plan is u_t, see answerWith().
Plan MpcPolicy::plan() {
  if (!hasGoal()) throw std::logic_error("there is no goal image to plan to");
  const auto begin = Clock::now();
  prepare();
  cost_.setProblem(x_, z_ref_, offset_);
  std::function<bool()> stop = stop_;
  if (time_budget_.count() > 0.0) {
    stop = [this] { return Clock::now() - began_ >= time_budget_ || (stop_ && stop_()); };
  }
  Plan plan = planner_.solve(&rng_, stop);
  plan.solve_time = std::chrono::duration<double>(Clock::now() - begin).count();
  return plan;
}

/// Adds the torque that acted to the controller state (eq. 8). Predicts z_{t+1|t} = f(h_n) (eq. 2),
/// which observe() compares with z_{t+1} for the offset.
void MpcPolicy::apply(const Eigen::VectorXd& u) {
  if (offset_gain_ > 0.0) predicted_ = model_->predict(x_, u);
  x_.apply(u);
}

std::optional<double> MpcPolicy::goalDistance() const {
  const double spread = model_->info().feature_spread;
  if (!hasGoal() || !(spread > 0.0) || !std::isfinite(spread)) return std::nullopt;
  return (x_.features().col(0) - z_ref_).norm() / spread;
}

void MpcPolicy::startTrial(const TrialId& id) {
  startSegment();
  offset_.setZero();
  planner_.clear();
  rng_ = randomStream(id, StreamRole::kPlannerStarts);
}

void MpcPolicy::startSegment() {
  x_.clear();
  predicted_.resize(0);
}

MpcPolicy::MpcPolicy(std::shared_ptr<const Ddm> model, const MpcOptions& options)
    : model_(std::move(model)),
      offset_gain_(options.offset_gain),
      time_budget_(options.time_budget),
      z_ref_(model_->hasGoal() ? model_->goalFeature() : Eigen::VectorXd()),
      x_(model_->options().order, model_->featureDim(), model_->torqueDim()),
      offset_(Eigen::VectorXd::Zero(model_->featureDim())),
      cost_(makePlanCost(*model_, options)),
      planner_(&cost_, options) {}

EpsilonGreedy::EpsilonGreedy(std::shared_ptr<Policy> policy, const Options& options,
                             const TrialId& id)
    : policy_(std::move(policy)),
      options_(options),
      rng_(randomStream(id, StreamRole::kExploration)) {
  const auto require = [](bool ok, const std::string& problem) {
    if (!ok) throw std::invalid_argument(problem);
  };
  require(options.epsilon >= 0.0 && options.epsilon <= 1.0,
          textOf("epsilon must lie in [0, 1], got ", options.epsilon));
  require(policy_ != nullptr || options.epsilon == 1.0, "a trial with epsilon < 1 needs a model");
  require(options.hold_steps >= 1, textOf("hold_steps must be >= 1, got ", options.hold_steps));
  eigen_assert(options.max_torque.size() >= 1 && (options.max_torque.array() > 0.0).all());
  if (policy_ == nullptr) return;
  policy_->setExploring(options.epsilon > 0.0);
  policy_->startTrial(id);
}

void EpsilonGreedy::setGoal(const Image& goal) {
  if (policy_ != nullptr) policy_->setGoal(goal);
}

void EpsilonGreedy::correctTorque(const Eigen::VectorXd& torque) {
  if (torque.size() != options_.max_torque.size() || !torque.allFinite()) {
    throw std::invalid_argument(textOf("an applied torque must be ", options_.max_torque.size(),
                                       " finite number(s), one for each motor, got ",
                                       torque.size()));
  }
  if (acted_) acted_ = torque;
}

void EpsilonGreedy::startSegment() {
  acted_.reset();
  if (policy_ != nullptr) policy_->startSegment();
}

}  // namespace ddm
