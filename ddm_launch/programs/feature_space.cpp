// feature_space: what a run's model makes of its experience, and what it planned at one step.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_cache.h>
#include <ddm_files/plain_file.h>
#include <ddm_model/long_term_prediction.h>
#include <ddm_model/model_file.h>
#include <ddm_model/per_motor.h>
#include <ddm_model/solver_log.h>
#include <ddm_mpc/epsilon_greedy.h>
#include <ddm_mpc/mpc_policy.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <ddm_sim/plant_factory.h>
#include <ddm_sim/rig.h>
#include <ros/time.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "closed_loop.h"
#include "configuration.h"
#include "csv_text.h"
#include "torques_csv.h"

namespace ddm {
namespace {

namespace po = boost::program_options;

constexpr char kAbout[] =
    "Writes the features of a run: of all frames recorded up to a trial, and of one step of the\n"
    "greedy evaluation after it, with the plan made there. The evaluation is run again from its\n"
    "seed and must give the torques that were recorded: use the machine and build of the run.\n\n"
    "usage: rosrun ddm_launch feature_space RUN_DIR --trial K --step S --out FILE.csv\n\n"
    "Output: kind,step,z_1,z_2,... with kind experience, current, goal or plan\n\noptions";

struct Arguments {
  std::string run;
  int trial = 0;
  int step = 0;
  std::string out;
};

/// @return false where --help was asked for and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(kAbout);
  options.add_options()("trial", po::value(&arguments->trial)->required(),
                        "the model trained after this trial, and its greedy evaluation");
  options.add_options()("step", po::value(&arguments->step)->required(),
                        "step of the evaluation whose plan is wanted, from 0");
  options.add_options()("out", po::value(&arguments->out)->required(), "CSV file to write");
  po::options_description unnamed;
  unnamed.add_options()("run", po::value(&arguments->run)->required());
  po::positional_options_description names;
  names.add("run", 1);
  if (!parseCommandLine(argc, argv, options, unnamed, names)) return false;
  if (arguments->trial < 0 || arguments->trial > 999 || arguments->step < 0) {
    throw po::error("--trial must lie in [0, 999] and --step be >= 0");
  }
  return true;
}

std::string subfolder(const Arguments& arguments, const std::string& kind, int trial) {
  char number[16];
  std::snprintf(number, sizeof(number), "_%03d", trial);
  return arguments.run + "/" + kind + number;
}

DataSet experience(const Arguments& arguments, const Configuration& all) {
  std::vector<std::string> bags;
  for (int k = 0; k <= arguments.trial; ++k)
    bags.push_back(subfolder(arguments, "trial", k) + "/trial.bag");
  BagCache cache(all.model.image.size, all.model.data_set);
  return cache.read(bags);
}

/// The plan at one step of the greedy evaluation, which is run again up to there.
/// @throws std::runtime_error if there is no such step or plan, or the torques are not the recorded
Plan planAt(const Arguments& arguments, const Configuration& all,
            std::shared_ptr<const Ddm> model) {
  TrialId id;
  id.seed = static_cast<std::uint64_t>(all.experiment.seed);
  id.trial = static_cast<std::uint32_t>(arguments.trial);
  id.evaluation = true;
  Rig rig(makePlant(*all.plant), all.camera);
  EpsilonGreedy::Options options;
  options.epsilon = 0.0;
  options.max_torque = perMotor(all.mpc.max_torque, rig.plant().torqueDim(), "mpc/max_torque");
  EpsilonGreedy policy(std::make_shared<MpcPolicy>(std::move(model), all.mpc), options, id);
  const std::string file = subfolder(arguments, "evaluation", arguments.trial) + "/torques.csv";
  const std::vector<Eigen::VectorXd> recorded =
      parseTorquesCsv(readFile(file), all.plant_info.torque_names, file).torques;
  if (arguments.step >= static_cast<int>(recorded.size())) {
    throw std::runtime_error("--step must be less than the " + std::to_string(recorded.size()) +
                             " steps of " + file + ", got " + std::to_string(arguments.step));
  }
  Plan plan;
  runClosedLoop(
      &rig, &policy, id, all.model.image.size, arguments.step + 1,
      [&](const ClosedLoopFrame& frame) {
        const Decision& decision = frame.decision;
        const Eigen::VectorXd& torque = recorded[static_cast<size_t>(frame.index)];
        if ((decision.torque - torque).cwiseAbs().maxCoeff() > 1e-9) {
          throw std::runtime_error(file + ": the torque of step " + std::to_string(frame.index) +
                                   " is another here: use the machine and build that made the run");
        }
        plan = *decision.plan;
      });
  if (plan.status == PlanStatus::kFailed) {
    throw std::runtime_error("there is no plan at step " + std::to_string(arguments.step) + ": " +
                             plan.message);
  }
  return plan;
}

std::string row(const std::string& kind, Eigen::Index step,
                const Eigen::Ref<const Eigen::VectorXd>& z) {
  std::string text = kind + "," + std::to_string(step);
  for (Eigen::Index i = 0; i < z.size(); ++i) text += "," + formatDouble(z[i]);
  return text + "\n";
}

void run(const Arguments& arguments) {
  ParamReader reader = ParamReader::fromFiles({arguments.run + "/config.yaml"});
  const Configuration all = readConfiguration(&reader);
  const std::string file = subfolder(arguments, "trial", arguments.trial) + "/model.ddm";
  const auto model = std::make_shared<const Ddm>(deserialiseModel(readFile(file), file));
  const Eigen::MatrixXd Z = encodeAll(*model, experience(arguments, all));
  const Plan plan = planAt(arguments, all, model);

  std::string text = csvHeader("kind,step", featureNames(model->featureDim())) + "\n";
  for (Eigen::Index i = 0; i < Z.cols(); ++i) text += row("experience", i, Z.col(i));
  text += row("current", arguments.step, plan.features.col(0));
  text += row("goal", 0, plan.goal_feature);
  for (Eigen::Index k = 1; k < plan.features.cols(); ++k) {
    text += row("plan", arguments.step + k, plan.features.col(k));
  }
  writeFileAtomically(arguments.out, text);
  std::cout << "wrote " << arguments.out << "\n";
}

}  // namespace
}  // namespace ddm

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::silenceSolverLog();
  ddm::Arguments arguments;
  return ddm::runTool(
      "feature_space", [&] { return ddm::parse(argc, argv, &arguments); },
      [&] { ddm::run(arguments); });
}
