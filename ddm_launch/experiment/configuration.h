// The effective configuration of an experiment: every block that decides its outcome.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/model_config.h>
#include <ddm_common/option_checks.h>
#include <ddm_common/param_reader.h>
#include <ddm_mpc/mpc_options.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_robot/robot_options.h>
#include <ddm_sim/camera.h>
#include <ddm_sim/sim_options.h>
#include <yaml-cpp/yaml.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ddm {

/// Block `experiment`: what is run. Set by launch arguments and options.
struct ExperimentOptions {
  std::string preset = "paper";    ///< name of the preset
  std::string plant = "pendulum";  ///< name of the plant
  std::string method = "ddm";      ///< who learns and acts, see method.h
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
  std::string model;                   ///< model file that trial 0 explores with; empty: none
  std::vector<std::string> bags;       ///< trials before trial 0
  std::vector<std::string> checksums;  ///< of the bags, then of the model

  bool empty() const { return model.empty() && bags.empty(); }

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("model", model);
    visitor("bags", bags);
    visitor("checksums", checksums);
  }
  std::vector<std::string> problems() const { return {}; }
};

/// Block `trial`.
struct TrialOptions {
  int num_steps = 100;  ///< samples, each an image with its torque, of one episode [-]
  int episodes = 1;     ///< episodes from fresh initial states that make up one trial [-]

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

/// Block `evaluation`: what the plant does not say about greedy runs.
struct EvaluationOptions {
  double goal_distance = 0.0;  ///< tolerance without ground truth [spread of features]; 0: none
  bool record = false;         ///< write a bag of each greedy run

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("goal_distance", goal_distance);
    visitor("record", record);
  }
  std::vector<std::string> problems() const {
    OptionChecks checks("evaluation");
    checks.requireNotNegative("goal_distance", goal_distance);
    return checks.problems();
  }
};

struct Configuration {
  ExperimentOptions experiment;
  StartOptions start;
  TrialOptions trial;
  EvaluationOptions evaluation;
  std::shared_ptr<const PlantPlugin> plant;
  PlantInfo plant_info;  ///< of that plant
  CameraOptions camera;
  SimOptions sim;
  ModelConfig model;
  MpcOptions mpc;
  std::optional<RobotOptions> robot;  ///< empty: a simulated plant
  YAML::Node method_blocks;           ///< those that experiment/method alone reads, by name
};

/// Names of the torques of a trial, with units, one for each motor: those of the robot where there
/// is one, whatever the plant is.
std::vector<std::string> torqueNames(const Configuration& configuration);

/// Reads all blocks and checks each.
/// @throws std::invalid_argument with all problems, one per line
Configuration readEachBlock(ParamReader* reader);

/// Checks that the blocks fit together.
/// @throws std::invalid_argument with all contradictions, one per line
void requireConsistent(const Configuration& configuration);

/// Reads all blocks, checks each, and that they fit together.
/// @throws std::invalid_argument with all problems, one per line
Configuration readConfiguration(ParamReader* reader);

/// @throws std::invalid_argument if the schedule leaves f random, which no plan can follow
void requireLearnedPrediction(const TrainingOptions& training);

/// All blocks by name, in the order above, `start` only where it says something, those of the method
/// last. `goal` is no block of options: it tells readers of the file what counts as success.
YAML::Node toYaml(const Configuration& configuration);

}  // namespace ddm
