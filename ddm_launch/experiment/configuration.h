// The effective configuration of an experiment: every block that decides its outcome.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/model_config.h>
#include <ddm_common/param_reader.h>
#include <ddm_mpc/mpc_options.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_robot/robot_options.h>
#include <ddm_sim/camera_options.h>
#include <ddm_sim/sim_options.h>
#include <yaml-cpp/yaml.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment_options.h"

namespace ddm {

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

/// All blocks by name, in the order above, `start` and evaluation/num_steps only where they say
/// something, those of the method last.
YAML::Node toYaml(const Configuration& configuration);

}  // namespace ddm
