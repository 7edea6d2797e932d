// feature_space: writes the features of all images of an experiment and the plan at one step.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_bag_io/bag_cache.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/tool.h>
#include <ddm_model/ddm.h>
#include <ddm_model/minimise.h>
#include <ddm_mpc/controller.h>
#include <ddm_sim/environment.h>
#include <ddm_sim/plant.h>
#include <ros/time.h>

#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "configuration.h"
#include "evaluation.h"
#include "in_process_driver.h"
#include "run_folder.h"
#include "start.h"
#include "tables.h"

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

/// @return false if --help was given and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(kAbout);
  options.add_options()("trial", po::value(&arguments->trial)->required(),
                        "the model trained after this trial, and its greedy evaluation");
  options.add_options()("step", po::value(&arguments->step)->required(),
                        "step of the evaluation whose plan is wanted, from 0");
  options.add_options()("out", po::value(&arguments->out)->required(), "CSV file to write");
  const Positional run{"run", po::value(&arguments->run)->required(), 1};
  if (!parseCommandLine(argc, argv, options, run)) return false;
  if (arguments->trial < 0 || arguments->trial > 999 || arguments->step < 0) {
    throw po::error("--trial must lie in [0, 999] and --step be >= 0");
  }
  return true;
}

DataSet experience(const Arguments& arguments, const Configuration& all) {
  std::vector<std::string> bags;
  for (int k = 0; k <= arguments.trial; ++k) {
    for (int episode = 0; episode < all.trial.episodes; ++episode) {
      bags.push_back(arguments.run + "/" + runName({k, /*evaluation=*/false, episode}) +
                     "/trial.bag");
    }
  }
  return BagCache(all.model.image.size, all.model.data_set).read(bags);
}

/// The plan at one step of the greedy evaluation. The evaluation is repeated up to this step.
/// @throws std::runtime_error if there is no such step or plan, or if the repeated torques differ
///         from the recorded ones
Plan planAt(const Arguments& arguments, const Configuration& all,
            const std::shared_ptr<const Ddm>& model) {
  const std::string file =
      arguments.run + "/" + runName({arguments.trial, /*evaluation=*/true}) + "/torques.csv";
  const std::vector<Eigen::VectorXd> recorded =
      parseTorquesCsv(readFile(file), all.plant_info.torque_names, file).torques;
  if (arguments.step >= static_cast<int>(recorded.size())) {
    throw std::runtime_error("--step must be less than the " + std::to_string(recorded.size()) +
                             " steps of " + file + ", got " + std::to_string(arguments.step));
  }
  TrialRequest request = requestFor(all, arguments.trial, /*evaluation=*/true);
  request.num_steps = arguments.step + 1;
  Environment environment(makePlant(*all.plant), all.camera);
  Plan plan;
  const auto take = [&](const ClosedLoopFrame& frame) {
    const Eigen::VectorXd& torque = recorded[static_cast<size_t>(frame.index)];
    if ((frame.decision.torque - torque).cwiseAbs().maxCoeff() > 1e-9) {
      throw std::runtime_error(file + ": the torque of step " + std::to_string(frame.index) +
                               " is another here: use the machine and build that made the run");
    }
    plan = *frame.decision.plan;
  };
  runClosedLoop(&environment, std::make_shared<MpcPolicy>(model, all.mpc), request, all, take);
  if (plan.status == PlanStatus::kFailed) {
    throw std::runtime_error("there is no plan at step " + std::to_string(arguments.step) + ": " +
                             plan.message);
  }
  return plan;
}

void run(const Arguments& arguments) {
  ParamReader reader = ParamReader::fromFiles({arguments.run + "/config.yaml"});
  const Configuration all = readConfiguration(&reader);
  const std::shared_ptr<const Ddm> model =
      readModel(arguments.run + "/" + runName({arguments.trial}) + "/model.ddm");
  const Eigen::MatrixXd Z = encodeAll(*model, experience(arguments, all));
  const Plan plan = planAt(arguments, all, model);

  std::string text = csvLine("kind", "step", featureNames(model->featureDim()));
  for (Eigen::Index i = 0; i < Z.cols(); ++i) text += csvLine("experience", i, Z.col(i));
  text += csvLine("current", arguments.step, plan.features.col(0));
  text += csvLine("goal", 0, plan.goal_feature);
  for (Eigen::Index k = 1; k < plan.features.cols(); ++k) {
    text += csvLine("plan", arguments.step + k, plan.features.col(k));
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
