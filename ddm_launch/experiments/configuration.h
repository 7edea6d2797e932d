// The effective configuration of an experiment: every block that decides its outcome.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_bag_io/model_config.h>
#include <ddm_mpc/mpc_options.h>
#include <ddm_msgs/param_reader.h>
#include <ddm_sim/plant_options.h>
#include <yaml-cpp/yaml.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment_options.h"
#include "robot_options.h"

namespace ddm {

class MethodSetup;

struct Configuration {
  ExperimentOptions experiment;
  StartOptions start;
  TrialOptions trial;
  EvaluationOptions evaluation;
  PlantOptions plant;
  CameraOptions camera;
  SimOptions sim;
  ModelConfig model;
  MpcOptions mpc;
  std::optional<RobotOptions> robot;          ///< empty: a simulated plant
  std::shared_ptr<const MethodSetup> method;  ///< null: the nodes, whose method is ddm
};

/// Reads all blocks and checks each, and that they fit together.
/// @throws std::invalid_argument with all problems, one per line
Configuration readConfiguration(ParamReader* reader);

/// @throws std::invalid_argument if the schedule leaves f random, which no plan can follow
void requireLearnedPrediction(const TrainingOptions& training);

/// All blocks by name, in the order above, `start` only where it says something, those of the
/// method last.
YAML::Node toYaml(const Configuration& configuration);

/// The files that make up a configuration, the manual first, what differs last: a plant knows
/// better than a preset what it needs.
/// @param preset   name in ddm_launch/config/presets
/// @param plant    name in ddm_sim/config, or PACKAGE/NAME in the folder config of that package
/// @param configs  further files, later ones win
/// @throws std::invalid_argument naming what there is, if there is no such preset or plant
std::vector<std::string> configurationFiles(const std::string& preset, const std::string& plant,
                                            const std::vector<std::string>& configs);

/// NAME.yaml in ddm_launch/config/nuisances: something that is wrong with the camera's images.
/// @throws std::invalid_argument naming what there is, if there is no such nuisance
std::string nuisanceFile(const std::string& name);

/// FILE.yaml in ddm_launch/config/methods: what a method wants other than the presets; empty if
/// there is none.
std::string methodFile(const std::string& method);

}  // namespace ddm
