// Checks that a plant keeps the rules that its users rely on.
// SPDX-License-Identifier: BSD-3-Clause
#include "plant_check.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

#include "ddm_sim/few_numbers.h"

namespace ddm {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kMaxDim = 1000;       // as in model files
constexpr int kRehearsedSteps = 3;  // enough to expose state that setState() does not set
constexpr double kPi = 3.14159265358979323846;
constexpr double kAngleRounding = 1e-9;  // [rad]

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return "\"" + out + "\"";
}

/// A name becomes the header of a column in CSV files.
bool usableName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c > ' ' && c < 127 && c != ',' && c != '"';
  });
}

/// What a plant did in a few steps from one start.
struct Rehearsal {
  std::vector<Eigen::VectorXd> states;
  std::vector<Bytes> pictures;
};

Rehearsal rehearse(Plant* plant) {
  std::mt19937_64 engine = startStream(0, 0, false);
  plant->setState(plant->drawStart(engine));
  Rehearsal out;
  for (int step = 0;; ++step) {
    out.states.push_back(plant->state());
    out.pictures.push_back(plant->render(plant->state()));
    if (step == kRehearsedSteps) return out;
    const double sign = step % 2 == 0 ? 1.0 : -1.0;
    plant->step(Eigen::VectorXd::Constant(plant->torqueDim(), sign * plant->maxTorque()));
  }
}

/// Collects the problems of one plant.
class PlantCheck {
 public:
  PlantCheck(Plant* plant, const PlantOptions& options, const CameraOptions& camera)
      : plant_(*plant), options_(options), camera_(camera) {}

  const std::vector<std::string>& problems() const { return problems_; }

  /// What it says of itself.
  void checkNumbers() {
    const int states = plant_.stateDim();
    require(states >= 1 && states <= kMaxDim, "stateDim() must lie in [1, 1000]", states);
    const int torques = plant_.torqueDim();
    require(torques >= 1 && torques <= kMaxDim, "torqueDim() must lie in [1, 1000]", torques);
    require(plant_.dt() == options_.dt, "dt() must be plant/dt", plant_.dt());
    require(plant_.maxTorque() == options_.max_torque, "maxTorque() must be plant/max_torque",
            plant_.maxTorque());
    require(plant_.imageSize() == camera_.size, "imageSize() must be camera/size",
            plant_.imageSize());
    require(plant_.state().allFinite(), "state() must be finite at the start",
            fewNumbers(plant_.state()));
  }

  void checkNames() {
    const std::vector<std::string> joints = plant_.jointNames();
    const int num_joints = static_cast<int>(joints.size());
    require(num_joints >= 1 && num_joints <= plant_.stateDim(),
            "jointNames() must be at least one and at most one for each component of the state",
            joined(joints));
    requireUsable("jointNames()", joints);
    requireOneForEach("stateNames()", plant_.stateNames(), plant_.stateDim(), "the state");
    requireOneForEach("torqueNames()", plant_.torqueNames(), plant_.torqueDim(), "the torque");
  }

  void checkGoal() {
    const Eigen::VectorXd goal = plant_.goalState();
    const bool usable = goal.size() == plant_.stateDim() && goal.allFinite();
    require(usable,
            "goalState() must be " + std::to_string(plant_.stateDim()) + " finite number(s)",
            fewNumbers(goal));
    if (!usable) return;
    const double farthest =
        plant_.turns() ? kPi + kAngleRounding : std::numeric_limits<double>::max();
    const std::string range = plant_.turns() ? "lie in [0, pi]" : "be >= 0 and finite";
    for (const Eigen::VectorXd& state : {goal, plant_.state()}) {
      const double distance = plant_.goalError(state);
      require(distance >= 0.0 && distance <= farthest,
              "distanceToGoal() of " + fewNumbers(state) + " must " + range, distance);
    }
  }

  /// How it looks at its start.
  void checkPicture() {
    const Eigen::VectorXd place = plant_.visiblePosition(plant_.state());
    require(place.size() == 2 && place.allFinite(), "locate() must be 2 finite numbers",
            fewNumbers(place));
    const Bytes picture = plant_.render(plant_.state());
    const Bytes cover = plant_.coverage(plant_.state());
    if (cover.empty()) {
      require(camera_.clutter == 0.0,
              "cover() must be implemented where camera/clutter is not 0: it says what hides the "
              "clutter",
              camera_.clutter);
      return;
    }
    for (std::size_t i = 0; i < picture.size(); ++i) {
      if (cover[i] >= picture[i]) continue;
      require(false,
              "cover() must be at least draw() (" + std::to_string(picture[i]) +
                  ") in each pixel, pixel " + std::to_string(i),
              static_cast<int>(cover[i]));
      return;
    }
  }

  void checkSteps(Plant* twin) {
    const Eigen::VectorXd start = plant_.state();
    const Rehearsal first = rehearse(&plant_);
    requireSame(first, rehearse(&plant_), "after a second setState() of the same plant");
    requireSame(first, rehearse(twin), "of a second plant with the same options");
    plant_.setState(start);
  }

  /// Runs a check; an exception is also a problem.
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

  void requireUsable(const std::string& function, const std::vector<std::string>& names) {
    const bool usable = std::all_of(names.begin(), names.end(), usableName) &&
                        std::set<std::string>(names.begin(), names.end()).size() == names.size();
    require(usable, function + " must differ, and have neither blanks nor commas nor quotes",
            joined(names));
  }

  void requireOneForEach(const std::string& function, const std::vector<std::string>& names,
                         int count, const std::string& whole) {
    require(static_cast<int>(names.size()) == count,
            function + " must be one for each of the " + std::to_string(count) +
                " component(s) of " + whole,
            joined(names));
    requireUsable(function, names);
  }

  void requireSame(const Rehearsal& first, const Rehearsal& second, const std::string& when) {
    for (std::size_t t = 0; t < first.states.size(); ++t) {
      require(first.states[t] == second.states[t],
              "advance() must give the same for the same state and torque: " +
                  fewNumbers(first.states[t]) + " at step " + std::to_string(t),
              fewNumbers(second.states[t]) + " " + when);
      if (first.states[t] != second.states[t]) return;
      require(first.pictures[t] == second.pictures[t],
              "draw() must give the same for the same state " + fewNumbers(first.states[t]),
              "another picture " + when);
      if (first.pictures[t] != second.pictures[t]) return;
    }
  }

  Plant& plant_;
  const PlantOptions& options_;
  const CameraOptions& camera_;
  std::vector<std::string> problems_;
};

}  // namespace

void requireSound(Plant* plant, Plant* twin, const PlantOptions& options,
                  const CameraOptions& camera) {
  std::vector<std::string> problems{"there must be a plant, got none"};
  if (plant != nullptr && twin != nullptr) {
    PlantCheck check(plant, options, camera);
    check.run("sizes and limits", [&] { check.checkNumbers(); });
    check.run("names", [&] { check.checkNames(); });
    check.run("goalState() or distanceToGoal()", [&] { check.checkGoal(); });
    // The rest relies on these sizes.
    if (check.problems().empty())
      check.run("locate(), draw() or cover()", [&] { check.checkPicture(); });
    if (check.problems().empty()) check.run("advance() or draw()", [&] { check.checkSteps(twin); });
    problems = check.problems();
  }
  if (problems.empty()) return;
  std::string text = "plant " + options.type + " breaks the rules of a plant:";
  for (const std::string& problem : problems) text += "\n- " + problem;
  throw std::invalid_argument(text + "\nCorrect its class: doc/your_plant.md has the rules");
}

}  // namespace ddm
