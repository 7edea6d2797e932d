// The effective configuration of an experiment: every block that decides its outcome.
// SPDX-License-Identifier: BSD-3-Clause
#include "configuration.h"

#include <ddm_model/per_motor.h>
#include <ddm_model/schedule.h>
#include <ddm_sim/plant_factory.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "method.h"

namespace ddm {
namespace {

/// What no block can see by itself.
std::vector<std::string> contradictions(const Configuration& all) {
  std::vector<std::string> out;
  const auto require = [&out](bool ok, const std::string& rule, const auto& value) {
    if (ok) return;
    std::ostringstream text;
    text << rule << ", got " << value;
    out.push_back(text.str());
  };
  const std::string motor = all.robot ? "robot/max_torque" : "plant/max_torque";
  const Eigen::VectorXd& of_plant = all.plant_info.max_torque;
  const std::vector<double> limits =
      all.robot ? all.robot->max_torque
                : std::vector<double>(of_plant.data(), of_plant.data() + of_plant.size());
  require(within(all.mpc.max_torque, limits),
          "mpc/max_torque must be at most " + motor + ", beyond which the motor saturates",
          limitsText(all.mpc.max_torque));
  require(within(all.mpc.max_torque, all.model.model.max_torque),
          "mpc/max_torque must be at most model/max_torque, which scales what f sees",
          limitsText(all.mpc.max_torque));
  require(all.mpc.time_budget <= (all.robot ? all.robot->dt : all.plant_info.dt),
          std::string("mpc/time_budget must be at most ") + (all.robot ? "robot/dt" : "plant/dt") +
              ", when the next image comes",
          all.mpc.time_budget);
  require(all.evaluation.settled_steps_strict <= all.trial.num_steps,
          "evaluation/settled_steps_strict must be at most trial/num_steps",
          all.evaluation.settled_steps_strict);
  require(all.trial.num_steps > all.model.model.pca_dim,
          "trial/num_steps must be more than model/pca_dim: the first model has one trial to learn "
          "from",
          all.trial.num_steps);
  require(all.trial.num_steps > all.model.model.order,
          "trial/num_steps must be more than model/order", all.trial.num_steps);
  return out;
}

}  // namespace

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
  all.evaluation.complete(all.plant_info);
  return all;
}

void requireConsistent(const Configuration& configuration) {
  std::string problems;
  for (const std::string& problem : contradictions(configuration)) problems += "\n - " + problem;
  if (!problems.empty()) throw std::invalid_argument("invalid configuration:" + problems);
}

Configuration readConfiguration(ParamReader* reader) {
  const Configuration all = readEachBlock(reader);
  requireConsistent(all);
  return all;
}

void requireLearnedPrediction(const TrainingOptions& training) {
  if (makeSchedule(training.schedule).terms().v_p) return;
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
  out["plant"] = configuration.plant->block();
  out["camera"] = toYaml(configuration.camera);
  out["sim"] = toYaml(configuration.sim);
  for (const auto& block : toYaml(configuration.model)) out[block.first] = block.second;
  out["mpc"] = toYaml(configuration.mpc);
  if (configuration.robot) out["robot"] = toYaml(*configuration.robot);
  if (configuration.method != nullptr) {
    for (const auto& block : configuration.method->blocks()) out[block.first] = block.second;
  }
  return out;
}

}  // namespace ddm
