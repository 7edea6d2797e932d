// run_experiment: runs Algorithm 1 in one process, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/minimise.h>
#include <ros/time.h>

#include <string>
#include <vector>

#include "algorithm1.h"
#include "in_process_driver.h"
#include "method.h"
#include "resolution.h"
#include "start.h"

namespace po = boost::program_options;

namespace {

constexpr char kAbout[] =
    "Runs an experiment in one process: a random trial, then training, greedy evaluation and an\n"
    "epsilon-greedy trial in turn. The same command on the same folder resumes.\n\n"
    "usage: rosrun ddm_launch run_experiment --preset paper --plant pendulum --seed 3\n"
    "                                        --trials 15 --out DIR [--model FILE] [--bags BAG...]\n"
    "       rosrun ddm_launch run_experiment --repeat RUN --out DIR  (the same again)";

/// @return false if --help was given and has been printed
bool configure(int argc, char** argv, ddm::Configuration* configuration) {
  ddm::Arguments arguments;
  po::options_description options = ddm::configurationOptions(kAbout, &arguments);
  std::string methods = "who learns and acts:";
  for (const auto& kind : ddm::methodKinds()) methods += "\n" + kind.name + ": " + kind.about;
  auto add = options.add_options();
  add("seed", ddm::given<int>("experiment/seed", &arguments),
      "fixes every random draw; otherwise that of the files, or 0");
  add("out", ddm::given<std::string>("experiment/runs", &arguments)->required(),
      "folder for the results");
  add("trials", ddm::given<int>("experiment/trials", &arguments),
      "epsilon-greedy trials after the random one; otherwise as in the files, or 15");
  add("method", ddm::given<std::string>("experiment/method", &arguments), methods.c_str());
  add("model", ddm::given<std::string>("start/model", &arguments),
      "saved model that trial 0 explores with, instead of random torques");
  add("bags", ddm::given<std::vector<std::string>>("start/bags", &arguments)->multitoken(),
      "bags that count as trials before trial 0: every training learns from them; without --model "
      "trial 0 explores with the model trained on them");
  if (!ddm::parseCommandLine(argc, argv, options)) return false;
  ddm::ParamReader reader = ddm::resolve(arguments).reader();
  *configuration = ddm::readWithMethod(&reader);
  return true;
}

void run(ddm::Configuration configuration) {
  ddm::prepareStart(&configuration);
  // The driver is made before the folder, because a refused configuration must not leave a folder.
  ddm::InProcessDriver driver(configuration);
  ddm::RunFolder folder(configuration);
  ddm::Progress progress(configuration.experiment.trials, configuration.plant_info.error_unit);
  ddm::runExperiment(configuration, &driver, &folder, &progress);
}

}  // namespace

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::silenceSolverLog();
  ddm::Configuration configuration;
  return ddm::runTool(
      "run_experiment", [&] { return configure(argc, argv, &configuration); },
      [&] { run(configuration); });
}
