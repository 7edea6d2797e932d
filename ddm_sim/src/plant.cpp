// A plant: checks, saturation and start states, the same for every plant.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant.h"

#include <ddm_common/random_stream.h>

#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "ddm_sim/few_numbers.h"

namespace ddm {
namespace {

void requireFinite(const char* name, const Eigen::VectorXd& value, Eigen::Index size) {
  if (value.size() == size && value.allFinite()) return;
  std::ostringstream message;
  message << "plant: the " << name << " must be " << size << " finite number(s), got "
          << fewNumbers(value);
  throw std::invalid_argument(message.str());
}

/// @throws std::logic_error if draw() made something else than a picture
void requirePicture(const Picture& picture) {
  const bool sound = picture.width >= 1 && picture.height >= 1 &&
                     (picture.channels == 1 || picture.channels == 3) &&
                     picture.bytes.size() == picture.numBytes() &&
                     (picture.cover.empty() || picture.cover.size() == picture.numPixels());
  if (sound) return;
  std::ostringstream message;
  message << "plant: draw() must return a picture of 1 or 3 channels with a byte for each, and a "
             "cover of none or one for each pixel, got "
          << picture.width << " x " << picture.height << " x " << picture.channels << " with "
          << picture.bytes.size() << " and " << picture.cover.size() << " bytes";
  throw std::logic_error(message.str());
}

}  // namespace

Plant::Plant(PlantInfo info) : info_(std::move(info)), state_(info_.start), goal_(info_.goal) {}

void Plant::setState(const Eigen::VectorXd& state) {
  requireFinite("state", state, stateDim());
  state_ = state;
}

void Plant::setGoal(const Eigen::VectorXd& goal) {
  requireFinite("goal", goal, stateDim());
  goal_ = goal;
}

Eigen::VectorXd Plant::drawStart(std::mt19937_64& engine) const {
  std::normal_distribution<double> standard_normal;
  Eigen::VectorXd start = info_.start;
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    start[i] += info_.start_std[i] * standard_normal(engine);
  }
  return start;
}

Eigen::VectorXd Plant::drawGoal(std::mt19937_64& /*engine*/) const { return info_.goal; }

Eigen::VectorXd Plant::goalAt(const Eigen::VectorXd& target) const {
  throw std::invalid_argument("plant: this one has no target, got " + fewNumbers(target) +
                              ": its goal is " + fewNumbers(info_.goal));
}

Eigen::VectorXd Plant::saturated(const Eigen::VectorXd& torque) const {
  requireFinite("torque", torque, torqueDim());
  return torque.cwiseMax(-info_.max_torque).cwiseMin(info_.max_torque);
}

Eigen::VectorXd Plant::step(const Eigen::VectorXd& torque) {
  const Eigen::VectorXd applied = saturated(torque);
  const Eigen::VectorXd next = advance(state_, applied);
  if (next.size() != state_.size()) {
    throw std::logic_error("plant: advance() must return " + std::to_string(state_.size()) +
                           " number(s), got " + fewNumbers(next));
  }
  if (!next.allFinite()) {
    std::ostringstream message;
    message << "plant " << info_.type << ": the state " << fewNumbers(state_) << " is followed by "
            << fewNumbers(next)
            << ", and states must be finite: use a smaller state or other plant parameters";
    throw std::range_error(message.str());
  }
  state_ = next;
  return applied;
}

double Plant::goalError(const Eigen::VectorXd& state) const {
  requireFinite("state", state, stateDim());
  return distance(state, goal_);
}

std::optional<double> Plant::reward(const Eigen::VectorXd& /*state*/,
                                    const Eigen::VectorXd& /*torque*/) const {
  return std::nullopt;
}

std::optional<double> Plant::stepReward(const Eigen::VectorXd& state, const Eigen::VectorXd& torque,
                                        int num_steps) const {
  requireFinite("state", state, stateDim());
  const Eigen::VectorXd applied = saturated(torque);
  if (!reward(state, applied)) return std::nullopt;
  Eigen::VectorXd from = state;
  double sum = rewardOfStep(from, applied);
  for (int i = 1; i < num_steps; ++i) {
    from = advance(from, applied);
    sum += rewardOfStep(from, applied);
  }
  return sum;
}

double Plant::rewardOfStep(const Eigen::VectorXd& state, const Eigen::VectorXd& torque) const {
  return reward(advance(state, torque), torque).value();
}

Picture Plant::render(const Eigen::VectorXd& state) const {
  requireFinite("state", state, stateDim());
  Picture picture = draw(state);
  requirePicture(picture);
  return picture;
}

Picture Plant::view(const Eigen::VectorXd& /*state*/) const {
  throw std::logic_error("plant: this one has no view for people");
}

Eigen::VectorXd Plant::visiblePosition(const Eigen::VectorXd& state) const {
  requireFinite("state", state, stateDim());
  return locate(state);
}

std::mt19937_64 startStream(std::uint64_t seed, std::uint32_t trial, bool evaluation) {
  return randomStream({seed, trial, evaluation}, StreamRole::kStart);
}

Eigen::VectorXd goalOf(const Plant& plant, std::uint64_t seed, std::uint32_t trial,
                       bool evaluation) {
  std::mt19937_64 stream = randomStream({seed, trial, evaluation}, StreamRole::kGoal);
  return plant.drawGoal(stream);
}

}  // namespace ddm
