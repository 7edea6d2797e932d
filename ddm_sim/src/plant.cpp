// A plant: checks, saturation and start states, the same for every plant.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant.h"

#include <ddm_msgs/random_stream.h>

#include <sstream>
#include <stdexcept>
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

/// @throws std::logic_error if the function of the derived class made `got` of something
void requireCount(const char* function, std::size_t count, std::size_t got) {
  if (got == count) return;
  throw std::logic_error(std::string("plant: ") + function + " must return " +
                         std::to_string(count) + " bytes, one for each pixel, got " +
                         std::to_string(got));
}

}  // namespace

Plant::Plant(Eigen::VectorXd start, int torque_dim, double dt, double max_torque, double start_std)
    : start_(std::move(start)),
      state_(start_),
      torque_dim_(torque_dim),
      dt_(dt),
      max_torque_(max_torque),
      start_std_(start_std) {}

void Plant::setState(const Eigen::VectorXd& state) {
  requireFinite("state", state, state_.size());
  state_ = state;
}

Eigen::VectorXd Plant::drawStart(std::mt19937_64& engine) const {
  std::normal_distribution<double> standard_normal;
  Eigen::VectorXd start = start_;
  for (Eigen::Index i = 0; i < start.size(); ++i) start[i] += start_std_ * standard_normal(engine);
  return start;
}

Eigen::VectorXd Plant::step(const Eigen::VectorXd& torque) {
  requireFinite("torque", torque, torque_dim_);
  const Eigen::VectorXd applied = torque.cwiseMax(-max_torque_).cwiseMin(max_torque_);
  const Eigen::VectorXd next = advance(state_, applied);
  if (next.size() != state_.size()) {
    throw std::logic_error("plant: advance() must return " + std::to_string(state_.size()) +
                           " number(s), got " + fewNumbers(next));
  }
  if (!next.allFinite()) {
    std::ostringstream message;
    message << "plant: the state [" << state_.transpose()
            << "] leaves the range of double within one step; use a smaller state or other plant "
               "parameters";
    throw std::range_error(message.str());
  }
  state_ = next;
  return applied;
}

double Plant::goalError(const Eigen::VectorXd& state) const {
  requireFinite("state", state, state_.size());
  return distanceToGoal(state);
}

std::size_t Plant::numPixels() const {
  const auto size = static_cast<std::size_t>(imageSize());
  return size * size;
}

std::vector<std::uint8_t> Plant::render(const Eigen::VectorXd& state) const {
  requireFinite("state", state, state_.size());
  std::vector<std::uint8_t> picture = draw(state);
  requireCount("draw()", numPixels(), picture.size());
  return picture;
}

std::vector<std::uint8_t> Plant::coverage(const Eigen::VectorXd& state) const {
  requireFinite("state", state, state_.size());
  std::vector<std::uint8_t> cover = this->cover(state);
  if (!cover.empty()) requireCount("cover()", numPixels(), cover.size());
  return cover;
}

Eigen::VectorXd Plant::visiblePosition(const Eigen::VectorXd& state) const {
  requireFinite("state", state, state_.size());
  return locate(state);
}

std::mt19937_64 startStream(std::uint64_t seed, std::uint32_t trial, bool evaluation) {
  return randomStream({seed, trial, evaluation}, StreamRole::kStart);
}

}  // namespace ddm
