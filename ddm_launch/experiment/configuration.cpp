// The effective configuration of an experiment: all blocks that affect its result.
// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <ddm_model/per_motor.h>
#include <ddm_model/schedule.h>
#include <ddm_mpc/saturating_cost.h>
#include <ddm_sim/plant.h>

#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm {

std::vector<std::string> torqueNames(const Configuration& configuration) {
  if (!configuration.robot) return configuration.plant_info.torque_names;
  const int num_motors = configuration.robot->numMotors();
  if (num_motors == 1) return {"torque_nm"};
  std::vector<std::string> names;
  for (int i = 1; i <= num_motors; ++i) names.push_back("torque_" + std::to_string(i) + "_nm");
  return names;
}

Configuration readEachBlock(ParamReader* reader) {
  Configuration all;
  all.experiment = reader->read<ExperimentOptions>("experiment");
  all.start = reader->read<StartOptions>("start");
  all.trial = reader->read<TrialOptions>("trial");
  all.evaluation = reader->read<EvaluationOptions>("evaluation");
  all.plant = readPlant(reader);
  all.camera = reader->read<CameraOptions>("camera");
  all.sim = reader->read<SimOptions>("sim");
  all.model = readModelConfig(reader);
  all.mpc = reader->read<MpcOptions>("mpc");
  if (reader->has("robot")) all.robot = reader->read<RobotOptions>("robot");
  reader->requireValid();
  all.plant_info = makePlant(*all.plant)->info();
  return all;
}

void requireConsistent(const Configuration& all) {
  std::ostringstream problems;
  const auto require = [&problems](bool ok, const std::string& rule, const auto& value) {
    if (!ok) problems << "\n - " << rule << ", got " << value;
  };
  const std::string owner = all.robot ? "robot" : "plant";
  const Eigen::VectorXd& of_plant = all.plant_info.max_torque;
  const std::vector<double> limits =
      all.robot ? all.robot->max_torque
                : std::vector<double>(of_plant.data(), of_plant.data() + of_plant.size());
  const std::string torques = limitsText(all.mpc.max_torque);
  const ModelOptions& model = all.model.model;
  const int num_steps = all.trial.num_steps;
  require(
      within(all.mpc.max_torque, limits),
      "mpc/max_torque must be at most " + owner + "/max_torque, beyond which the motor saturates",
      torques);
  require(within(all.mpc.max_torque, model.max_torque),
          "mpc/max_torque must be at most model/max_torque, which scales what f sees", torques);
  require(
      all.mpc.cost == "distance" || static_cast<int>(limits.size()) <= SaturatingCost::kMaxMotors,
      "mpc/cost must be distance with more than " + std::to_string(SaturatingCost::kMaxMotors) +
          " motors, as the others compare 3^motors sets of torques",
      all.mpc.cost + " with the " + std::to_string(limits.size()) + " of " + owner + "/max_torque");
  require(all.mpc.time_budget <= (all.robot ? all.robot->dt : all.plant_info.dt),
          "mpc/time_budget must be at most " + owner + "/dt, when the next image comes",
          all.mpc.time_budget);
  require(num_steps * all.trial.episodes > model.pca_dim,
          "trial/num_steps times trial/episodes must be more than model/pca_dim: the first model "
          "has one trial to learn from",
          num_steps * all.trial.episodes);
  require(num_steps > model.order, "trial/num_steps must be more than model/order", num_steps);
  if (problems.tellp() > 0) {
    throw std::invalid_argument("invalid configuration:" + problems.str());
  }
}

Configuration readConfiguration(ParamReader* reader) {
  const Configuration all = readEachBlock(reader);
  requireConsistent(all);
  return all;
}

void requireLearnedPrediction(const TrainingOptions& training) {
  if (makeSchedule(training).terms().v_p) return;
  throw std::invalid_argument(
      "training/schedule must be one with V_P where a plan follows f, got " + training.schedule +
      ": it is for run_experiment --method pilco_features");
}

YAML::Node toYaml(const Configuration& configuration) {
  YAML::Node out(YAML::NodeType::Map);
  out["experiment"] = toYaml(configuration.experiment);
  if (!configuration.start.empty()) out["start"] = toYaml(configuration.start);
  out["trial"] = toYaml(configuration.trial);
  out["evaluation"] = toYaml(configuration.evaluation);
  out["goal"]["error_unit"] = configuration.plant_info.error_unit;
  out["goal"]["tolerance"] = valueToYaml(configuration.plant_info.tolerance);
  out["plant"] = configuration.plant->block();
  out["camera"] = toYaml(configuration.camera);
  out["sim"] = toYaml(configuration.sim);
  for (const auto& block : toYaml(configuration.model)) out[block.first] = block.second;
  out["mpc"] = toYaml(configuration.mpc);
  if (configuration.robot) out["robot"] = toYaml(*configuration.robot);
  for (const auto& block : configuration.method_blocks) out[block.first] = block.second;
  return out;
}

}  // namespace ddm
