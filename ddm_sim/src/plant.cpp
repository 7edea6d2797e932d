// The base class of all plants: checks, saturation, initial states, and the rules for PlantInfo.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ddm {
namespace {

void requireFinite(const char* name, const Eigen::VectorXd& value, Eigen::Index size) {
  if (value.size() == size && value.allFinite()) return;
  throw std::invalid_argument(
      textOf("plant: the ", name, " must be ", size, " finite number(s), got ", fewNumbers(value)));
}

constexpr std::size_t kMaxDim = 1000;  // the limit of model files

/// The rules of checkedPlant() that a plant breaks.
std::vector<std::string> problemsOf(const PlantInfo& info) {
  OptionChecks checks("PlantInfo");
  const auto requireNames = [&checks](const char* key, const std::vector<std::string>& names) {
    checks.require(!names.empty() && names.size() <= kMaxDim, key, "be 1 to 1000 names",
                   names.size());
    const bool usable = std::all_of(names.begin(), names.end(), usableName) &&
                        std::set<std::string>(names.begin(), names.end()).size() == names.size();
    checks.require(usable, key, "differ, and have neither blanks nor commas nor quotes",
                   "\"" + boost::algorithm::join(names, ", ") + "\"");
  };
  const auto requireVector = [&checks](const char* key, const Eigen::VectorXd& values, int count) {
    checks.require(values.size() == count && values.allFinite(), key,
                   "be " + std::to_string(count) + " finite number(s)", fewNumbers(values));
  };
  std::vector<std::string> joints;
  for (const Joint& joint : info.joints) joints.push_back(joint.name);
  requireNames("state_names", info.state_names);
  requireNames("torque_names", info.torque_names);
  requireNames("joints", joints);
  checks.require(joints.size() <= info.state_names.size(), "joints",
                 "be at most one for each component of the state", joints.size());
  requireVector("max_torque", info.max_torque, info.torqueDim());
  requireVector("start", info.start, info.stateDim());
  requireVector("start_std", info.start_std, info.stateDim());
  requireVector("goal", info.goal, info.stateDim());
  checks.require((info.max_torque.array() > 0.0).all(), "max_torque", "be > 0",
                 fewNumbers(info.max_torque));
  checks.require((info.start_std.array() >= 0.0).all(), "start_std", "be >= 0",
                 fewNumbers(info.start_std));
  checks.requirePositive("dt", info.dt);
  checks.requirePositive("tolerance", info.tolerance);
  checks.require(usableName(info.error_unit), "error_unit", "name the unit of the error",
                 "\"" + info.error_unit + "\"");
  return checks.problems();
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
    throw std::range_error(
        "plant " + info_.type + ": the state " + fewNumbers(state_) + " is followed by " +
        fewNumbers(next) +
        ", and states must be finite: use a smaller state or other plant parameters");
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

RenderedImage Plant::render(const Eigen::VectorXd& state) const {
  requireFinite("state", state, stateDim());
  RenderedImage rendered = draw(state);
  const bool sound = rendered.width >= 1 && rendered.height >= 1 &&
                     (rendered.channels == 1 || rendered.channels == 3) &&
                     rendered.bytes.size() == rendered.numBytes() &&
                     (rendered.cover.empty() || rendered.cover.size() == rendered.numPixels());
  if (sound) return rendered;
  throw std::logic_error(
      textOf("plant: draw() must return a rendered image of 1 or 3 channels with a byte for each, "
             "and a cover of none or one for each pixel, got ",
             rendered.width, " x ", rendered.height, " x ", rendered.channels, " with ",
             rendered.bytes.size(), " and ", rendered.cover.size(), " bytes"));
}

RenderedImage Plant::view(const Eigen::VectorXd& /*state*/) const {
  throw std::logic_error("plant: this one has no view for people");
}

Eigen::VectorXd Plant::visiblePosition(const Eigen::VectorXd& state) const {
  requireFinite("state", state, stateDim());
  return locate(state);
}

Eigen::VectorXd goalOf(const Plant& plant, const TrialId& id) {
  std::mt19937_64 stream = randomStream(id, StreamRole::kGoal);
  return plant.drawGoal(stream);
}

bool usableName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c > ' ' && c < 127 && c != ',' && c != '"';
  });
}

std::unique_ptr<Plant> checkedPlant(std::unique_ptr<Plant> plant, const std::string& type) {
  const std::vector<std::string> problems =
      plant ? problemsOf(plant->info()) : std::vector<std::string>{"it must be made, got nothing"};
  if (problems.empty()) {
    plant->info_.type = type;
    return plant;
  }
  throw std::invalid_argument("plant " + type + " breaks the rules of a plant:\n- " +
                              boost::algorithm::join(problems, "\n- ") +
                              "\nCorrect its class: doc/your_plant.md has the rules");
}

std::string fewNumbers(const Eigen::VectorXd& numbers) {
  constexpr Eigen::Index kFew = 10;
  std::ostringstream text;
  text << "[" << numbers.head(std::min(numbers.size(), kFew)).transpose();
  if (numbers.size() > kFew) text << " ..., " << numbers.size() << " in all";
  text << "]";
  return text.str();
}

}  // namespace ddm
