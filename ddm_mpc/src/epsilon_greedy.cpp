// Epsilon-greedy exploration around a policy.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_mpc/epsilon_greedy.h"

#include <stdexcept>
#include <string>
#include <utility>

namespace ddm {

EpsilonGreedy::EpsilonGreedy(std::shared_ptr<Policy> policy, const Options& options,
                             const TrialId& id)
    : policy_(std::move(policy)),
      options_(options),
      rng_(randomStream(id, StreamRole::kExploration)) {
  setEpsilon(options_.epsilon);
  if (options_.hold_steps < 1) {
    throw std::invalid_argument("hold_steps must be >= 1, got " +
                                std::to_string(options_.hold_steps));
  }
  if (options_.max_torque.size() < 1 || !(options_.max_torque.array() > 0.0).all()) {
    throw std::invalid_argument("max_torque must be > 0 for each of at least one motor");
  }
  if (policy_ != nullptr) policy_->startTrial(id);
}

void EpsilonGreedy::setEpsilon(double epsilon) {
  if (!(epsilon >= 0.0 && epsilon <= 1.0)) {
    throw std::invalid_argument("epsilon must lie in [0, 1], got " + std::to_string(epsilon));
  }
  if (policy_ == nullptr && epsilon < 1.0) {
    throw std::invalid_argument("a trial with epsilon < 1 needs a model");
  }
  options_.epsilon = epsilon;
  if (policy_ != nullptr) policy_->setExploring(epsilon > 0.0);
}

void EpsilonGreedy::setGoal(const Grey& goal) {
  if (policy_ != nullptr) policy_->setGoal(goal);
}

void EpsilonGreedy::correctTorque(const Eigen::VectorXd& torque) {
  if (torque.size() != options_.max_torque.size() || !torque.allFinite()) {
    throw std::invalid_argument(
        "an applied torque must be " + std::to_string(options_.max_torque.size()) +
        " finite number(s), one for each motor, got " + std::to_string(torque.size()));
  }
  if (acted_) acted_ = torque;
}

void EpsilonGreedy::startSegment() {
  acted_.reset();
  if (policy_ != nullptr) policy_->startSegment();
}

Decision EpsilonGreedy::decide(const Grey& grey) {
  if (policy_ != nullptr && acted_) policy_->apply(*acted_);
  acted_.reset();
  if (policy_ != nullptr) policy_->observe(grey);
  Decision decision;
  if (policy_ != nullptr) decision.goal_distance = policy_->goalDistance();
  if (held_steps_left_ == 0) {
    std::uniform_real_distribution<double> probability(0.0, 1.0);
    if (probability(rng_) < options_.epsilon) {
      held_torque_.resize(options_.max_torque.size());
      for (Eigen::Index i = 0; i < held_torque_.size(); ++i) {
        const double limit = options_.max_torque[i];
        held_torque_[i] = std::uniform_real_distribution<double>(-limit, limit)(rng_);
      }
      held_steps_left_ = options_.hold_steps;
    }
  }
  if (held_steps_left_ > 0) {
    --held_steps_left_;
    decision.exploratory = true;
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

}  // namespace ddm
