// Parameters of an experiment. One struct = one YAML block.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>
#include <ddm_sim/plant_info.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace ddm {

/// Block `experiment`: what is run. Set by launch arguments and options.
struct ExperimentOptions {
  std::string preset = "paper";    ///< name of the preset
  std::string plant = "pendulum";  ///< name of the plant
  std::string method = "ddm";      ///< who learns and acts, see method_kinds.h
  int seed = 0;                    ///< fixes every random draw
  int trials = 15;                 ///< epsilon-greedy trials after the random one [-]
  std::string runs;                ///< folder for everything that the experiment leaves behind
  double timeout = 60.0;           ///< nodes: wall time without a sign of life [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("preset", preset);
    visitor("plant", plant);
    visitor("method", method);
    visitor("seed", seed);
    visitor("trials", trials);
    visitor("runs", runs);
    visitor("timeout", timeout);
  }
  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const {
    OptionChecks checks("experiment");
    checks.requireAtLeast("seed", seed, 0);
    checks.requireWithin("trials", trials, 0, 999);
    checks.requireTimeLimit("timeout", timeout);
    return checks.problems();
  }
};

/// Block `start`: what an experiment begins with instead of nothing. Completed by prepareStart().
struct StartOptions {
  std::string model;                 ///< model file that trial 0 explores with; empty: none
  std::vector<std::string> bags;     ///< trials before trial 0
  std::string model_id;              ///< checksum of the model file
  std::vector<std::string> bag_ids;  ///< checksums of the bags

  bool empty() const { return model.empty() && bags.empty(); }

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("model", model);
    visitor("bags", bags);
    visitor("model_id", model_id);
    visitor("bag_ids", bag_ids);
  }
  std::vector<std::string> problems() const { return {}; }
};

/// Block `trial`.
struct TrialOptions {
  int num_steps = 100;  ///< frames, and so torques, of one episode [-]
  int episodes = 1;     ///< runs from fresh starts that make up one trial [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("num_steps", num_steps);
    visitor("episodes", episodes);
  }
  std::vector<std::string> problems() const {
    OptionChecks checks("trial");
    checks.requireWithin("num_steps", num_steps, 1, 1000000);
    checks.requireWithin("episodes", episodes, 1, 1000);
    return checks.problems();
  }
};

/// Block `evaluation`: how long a greedy run lasts, and when it is a success.
struct EvaluationOptions {
  int num_steps = 0;              ///< its frames [-]; 0: the plant's own, else those of a trial
  double tolerance = 0.0;         ///< largest error [error_unit]; 0: the plant's own
  std::string error_unit;         ///< unit of the plant's error; empty: whatever it is
  int settled_steps = 10;         ///< last frames that must be within it: `success` [-]
  int settled_steps_strict = 25;  ///< the same for `success_strict` [-]
  double goal_distance = 0.0;     ///< tolerance without ground truth [spread of features]; 0: none
  bool record = false;            ///< write a bag of each greedy run

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("num_steps", num_steps);
    visitor("tolerance", tolerance);
    visitor("error_unit", error_unit);
    visitor("settled_steps", settled_steps);
    visitor("settled_steps_strict", settled_steps_strict);
    visitor("goal_distance", goal_distance);
    visitor("record", record);
  }
  std::vector<std::string> problems() const {
    OptionChecks checks("evaluation");
    checks.requireWithin("num_steps", num_steps, 0, 1000000);
    checks.requireNotNegative("tolerance", tolerance);
    checks.requireAtLeast("settled_steps", settled_steps, 1);
    checks.require(settled_steps_strict >= settled_steps, "settled_steps_strict",
                   "be >= evaluation/settled_steps", settled_steps_strict);
    checks.requireNotNegative("goal_distance", goal_distance);
    return checks.problems();
  }

  int stepsWith(const TrialOptions& trial) const {
    return num_steps > 0 ? num_steps : trial.num_steps;
  }

  /// Fills in what the plant says.
  /// @throws std::invalid_argument if the error of this plant has another unit
  void complete(const PlantInfo& plant) {
    if (!error_unit.empty() && error_unit != plant.error_unit) {
      throw std::invalid_argument("evaluation/error_unit must be that of the plant, " +
                                  plant.error_unit + ", got " + error_unit +
                                  ": leave it out, and give evaluation/tolerance in that unit");
    }
    error_unit = plant.error_unit;
    if (tolerance == 0.0) tolerance = plant.tolerance;
    if (num_steps == 0) num_steps = plant.evaluation_steps;
  }
};

}  // namespace ddm
