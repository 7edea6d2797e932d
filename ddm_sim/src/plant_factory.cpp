// Makes plants, and refuses those that break the rules of class Plant.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_sim/plant_factory.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <functional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "ddm_sim/few_numbers.h"

namespace ddm {
namespace {

constexpr int kMaxDim = 1000;       // as in model files
constexpr int kRehearsedSteps = 3;  // enough to expose state that setState() does not set

std::string joined(const std::vector<std::string>& names) {
  return "\"" + boost::algorithm::join(names, ", ") + "\"";
}

/// What a plant did in a few steps from one start.
struct Rehearsal {
  std::vector<Eigen::VectorXd> states;
  std::vector<Picture> pictures;
};

/// @param draw  whether to look at it
Rehearsal rehearse(Plant* plant, bool draw) {
  std::mt19937_64 engine = startStream(0, 0, false);
  plant->setState(plant->drawStart(engine));
  Rehearsal out;
  for (int step = 0;; ++step) {
    out.states.push_back(plant->state());
    out.pictures.push_back(draw ? plant->render(plant->state()) : Picture());
    if (step == kRehearsedSteps) return out;
    plant->step((step % 2 == 0 ? 1.0 : -1.0) * plant->info().max_torque);
  }
}

bool sameSize(const Picture& a, const Picture& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels;
}

/// Collects the broken rules of one plant.
class PlantRules {
 public:
  PlantRules(Plant* plant, bool draw) : plant_(*plant), info_(plant->info()), draw_(draw) {}

  const std::vector<std::string>& problems() const { return problems_; }

  void checkInfo() {
    std::vector<std::string> joints;
    for (const Joint& joint : info_.joints) joints.push_back(joint.name);
    requireNames("state_names", info_.state_names);
    requireNames("torque_names", info_.torque_names);
    requireNames("joints", joints);
    require(info_.joints.size() <= info_.state_names.size(),
            "joints must be at most one for each component of the state", joined(joints));
    requireVector("max_torque", info_.max_torque, info_.torqueDim());
    require(info_.max_torque.size() > 0 && info_.max_torque.minCoeff() > 0.0,
            "max_torque must be > 0", fewNumbers(info_.max_torque));
    requireVector("start", info_.start, info_.stateDim());
    requireVector("start_std", info_.start_std, info_.stateDim());
    require(info_.start_std.size() == 0 || info_.start_std.minCoeff() >= 0.0,
            "start_std must be >= 0", fewNumbers(info_.start_std));
    requireVector("goal", info_.goal, info_.stateDim());
    require(info_.dt > 0.0 && std::isfinite(info_.dt), "dt must be > 0 and finite", info_.dt);
    require(info_.tolerance > 0.0 && std::isfinite(info_.tolerance),
            "tolerance must be > 0 and finite", info_.tolerance);
    require(usableName(info_.error_unit), "error_unit must name the unit of the error",
            joined({info_.error_unit}));
  }

  void checkGoal() {
    const Eigen::VectorXd goal = goalOf(plant_, 0, 0, false);
    requireVector("the goal from drawGoal()", goal, info_.stateDim());
    if (!problems_.empty()) return;
    require(goal == goalOf(plant_, 0, 0, false),
            "drawGoal() must give the same for the same engine", "another goal");
    plant_.setGoal(goal);
    require(plant_.goalError(goal) <= info_.tolerance,
            "the error at the goal must be within the tolerance", plant_.goalError(goal));
    require(!draw_ || sameSize(plant_.render(goal), plant_.render(plant_.state())),
            "draw() must give pictures of one size", "another size at the goal");
    const double error = plant_.goalError(plant_.state());
    require(error >= 0.0 && std::isfinite(error),
            "the error of " + fewNumbers(plant_.state()) + " must be >= 0 and finite", error);
  }

  void checkPicture() {
    const Eigen::VectorXd place = plant_.visiblePosition(plant_.state());
    require(place.size() >= 1 && place.allFinite(),
            "visiblePosition() must be finite numbers, at least one", fewNumbers(place));
    if (!draw_) return;
    const Picture picture = plant_.render(plant_.state());
    for (std::size_t i = 0; i < picture.cover.size(); ++i) {
      const auto first = picture.bytes.begin() + static_cast<std::ptrdiff_t>(i) * picture.channels;
      const int brightest = *std::max_element(first, first + picture.channels);
      if (picture.cover[i] >= brightest) continue;
      require(false,
              "cover must be at least as much as the picture is bright (" +
                  std::to_string(brightest) + ") in each pixel, pixel " + std::to_string(i),
              static_cast<int>(picture.cover[i]));
      return;
    }
  }

  void checkSteps(Plant* twin) {
    const Rehearsal first = rehearse(&plant_, draw_);
    requireSame(first, rehearse(&plant_, draw_), "after a second setState() of the same plant");
    requireSame(first, rehearse(twin, draw_), "of a second plant with the same options");
    const double reward = plant_.stepReward(first.states[0], info_.max_torque).value_or(0.0);
    require(std::isfinite(reward), "reward() must be finite", reward);
    plant_.setState(info_.start);
    plant_.setGoal(info_.goal);
  }

  /// Runs a check; an exception is also a broken rule.
  void run(const std::string& functions, const std::function<void()>& check) {
    try {
      check();
    } catch (const std::exception& e) {
      problems_.push_back(functions + " failed: " + e.what());
    }
  }

 private:
  template <class Value>
  void require(bool ok, const std::string& rule, const Value& value) {
    if (ok) return;
    std::ostringstream problem;
    problem << rule << ", got " << value;
    problems_.push_back(problem.str());
  }

  void requireNames(const std::string& what, const std::vector<std::string>& names) {
    require(!names.empty() && names.size() <= static_cast<std::size_t>(kMaxDim),
            what + " must be 1 to 1000 names", names.size());
    const bool usable = std::all_of(names.begin(), names.end(), usableName) &&
                        std::set<std::string>(names.begin(), names.end()).size() == names.size();
    require(usable, what + " must differ, and have neither blanks nor commas nor quotes",
            joined(names));
  }

  void requireVector(const std::string& what, const Eigen::VectorXd& values, int count) {
    require(values.size() == count && values.allFinite(),
            what + " must be " + std::to_string(count) + " finite number(s)", fewNumbers(values));
  }

  void requireSame(const Rehearsal& first, const Rehearsal& second, const std::string& when) {
    for (std::size_t t = 0; t < first.states.size(); ++t) {
      require(first.states[t] == second.states[t],
              "advance() must give the same for the same state and torque: " +
                  fewNumbers(first.states[t]) + " at step " + std::to_string(t),
              fewNumbers(second.states[t]) + " " + when);
      if (first.states[t] != second.states[t]) return;
      const bool same = sameSize(first.pictures[t], second.pictures[t]) &&
                        sameSize(first.pictures[t], first.pictures[0]) &&
                        first.pictures[t].bytes == second.pictures[t].bytes;
      require(same,
              "draw() must give the same for the same state " + fewNumbers(first.states[t]) +
                  ", always of one size",
              "another picture " + when);
      if (!same) return;
    }
  }

  Plant& plant_;
  const PlantInfo& info_;
  bool draw_;  // whether pictures are looked at
  std::vector<std::string> problems_;
};

std::vector<std::string> brokenRules(Plant* plant, Plant* twin, bool draw) {
  if (plant == nullptr || twin == nullptr) return {"there must be a plant, got none"};
  PlantRules rules(plant, draw);
  rules.checkInfo();
  if (!rules.problems().empty()) return rules.problems();  // the rest relies on these sizes
  rules.run("drawGoal(), distance() or draw()", [&] { rules.checkGoal(); });
  rules.run("locate() or draw()", [&] { rules.checkPicture(); });
  if (rules.problems().empty()) rules.run("advance() or draw()", [&] { rules.checkSteps(twin); });
  return rules.problems();
}

}  // namespace

bool usableName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c > ' ' && c < 127 && c != ',' && c != '"';
  });
}

std::unique_ptr<Plant> makePlant(const PlantMaker& maker) {
  std::unique_ptr<Plant> plant = maker.make();
  const std::vector<std::string> problems =
      brokenRules(plant.get(), maker.make().get(), maker.drawsCheaply());
  if (problems.empty()) {
    plant->setType(maker.type());
    return plant;
  }
  std::string text = "plant " + maker.type() + " breaks the rules of a plant:";
  for (const std::string& problem : problems) text += "\n- " + problem;
  const bool own = maker.type() != "mujoco";  // a model file has no class that somebody wrote
  throw std::invalid_argument(text +
                              (own ? "\nCorrect its class: doc/your_plant.md has the rules" : ""));
}

}  // namespace ddm
