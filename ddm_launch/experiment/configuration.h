// The effective configuration of an experiment: all blocks that affect its result.
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

/// Block `experiment`: what to run. Launch arguments and command line options set these values.
struct ExperimentOptions {
  std::string preset = "paper";    ///< name of the preset
  std::string plant = "pendulum";  ///< name of the plant
  std::string method = "ddm";      ///< name of the method, see method.h
  int seed = 0;                    ///< fixes every random draw
  int trials = 15;                 ///< epsilon-greedy trials after the random one [-]
  std::string runs;                ///< folder for all files of the experiment
  double timeout = 60.0;           ///< nodes: longest wall time without any message or progress [s]

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
  /// All problems with these values, in words a user can act on. Empty if the values are valid.
  std::vector<std::string> problems() const {
    OptionChecks checks("experiment");
    checks.requireAtLeast("seed", seed, 0);
    checks.requireWithin("trials", trials, 0, 999);
    checks.requireTimeLimit("timeout", timeout);
    return checks.problems();
  }
};

/// Block `start`: model and data that the experiment starts from. prepareStart() completes the
/// block.
struct StartOptions {
  std::string model;                   ///< model file for the exploration of trial 0; empty: none
  std::vector<std::string> bags;       ///< data of trials before trial 0
  std::vector<std::string> checksums;  ///< one per bag, then that of the model

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
  int num_steps = 100;  ///< samples in one episode; a sample is an image and its torque [-]
  int episodes = 1;     ///< episodes in one trial, each with its own initial state [-]

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

/// Block `evaluation`: settings of greedy evaluations that the plant does not define.
struct EvaluationOptions {
  double goal_distance = 0.0;  ///< tolerance without ground truth [spread of features]; 0: none
  bool record = false;         ///< whether to write a bag of each evaluation

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

/// All blocks of a configuration, and the plant that they describe.
struct Configuration {
  ExperimentOptions experiment;
  StartOptions start;
  TrialOptions trial;
  EvaluationOptions evaluation;
  std::shared_ptr<const PlantPlugin> plant;
  PlantInfo plant_info;  ///< properties of `plant`
  CameraOptions camera;
  SimOptions sim;
  ModelConfig model;
  MpcOptions mpc;
  std::optional<RobotOptions> robot;  ///< empty if the plant is simulated
  YAML::Node method_blocks;           ///< blocks that only experiment/method reads, by name
};

/// Column names of the torques of a trial, with units, one per motor. If a robot is configured, its
/// motors count, not those of the plant.
std::vector<std::string> torqueNames(const Configuration& configuration);

/// Reads all blocks and checks each block by itself.
/// @throws std::invalid_argument listing all problems, one per line
Configuration readEachBlock(ParamReader* reader);

/// Checks that the blocks fit together.
/// @throws std::invalid_argument listing all contradictions, one per line
void requireConsistent(const Configuration& configuration);

/// Reads all blocks, checks each block, and checks that the blocks fit together.
/// @throws std::invalid_argument listing all problems, one per line
Configuration readConfiguration(ParamReader* reader);

/// Checks that the training schedule minimises V_P. Without V_P, the prediction model f keeps its
/// random initial weights and cannot be used for planning.
/// @throws std::invalid_argument if the schedule has no V_P
void requireLearnedPrediction(const TrainingOptions& training);

/// All blocks by name in the order of Configuration. `start` is left out if it is empty. The block
/// `goal` holds no options: it tells readers of the file which error counts as success.
YAML::Node toYaml(const Configuration& configuration);

}  // namespace ddm
