// run_experiment: Algorithm 1 in one process, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/solver_log.h>
#include <ros/time.h>
#include <unistd.h>

#include <iostream>
#include <string>
#include <vector>

#include "command_line.h"
#include "experiment.h"
#include "in_process_driver.h"
#include "start.h"

namespace po = boost::program_options;

namespace {

constexpr char kAbout[] =
    "Runs an experiment in one process: a random trial, then training, greedy evaluation and an\n"
    "epsilon-greedy trial in turn. The same command on the same folder resumes.\n\n"
    "usage: rosrun ddm_launch run_experiment --preset paper --plant pendulum --seed 3\n"
    "                                        --trials 15 --out DIR [--model FILE] [--bags BAG...]\n"
    "       rosrun ddm_launch run_experiment --config RUN/config.yaml --out DIR  (the same again)";

/// @return false where --help was asked for and has been printed
bool configure(int argc, char** argv, ddm::Configuration* configuration) {
  ddm::Arguments arguments;
  po::options_description options = ddm::commonOptions(kAbout, &arguments);
  options.add_options()("trials", ddm::given<int>("experiment/trials", &arguments),
                        "epsilon-greedy trials after the random one; otherwise as in the files, "
                        "or 15");
  ddm::addMethodOption(&options, &arguments);
  options.add_options()("model", ddm::given<std::string>("start/model", &arguments),
                        "saved model that trial 0 explores with, instead of random torques");
  options.add_options()(
      "bags", ddm::given<std::vector<std::string>>("start/bags", &arguments)->multitoken(),
      "bags that count as trials before trial 0: every training learns from them; "
      "without --model trial 0 explores with the model trained on them");
  if (!ddm::parseCommandLine(argc, argv, options)) return false;
  ddm::ParamReader reader = ddm::resolve(arguments).reader();
  *configuration = ddm::readWithMethod(&reader);
  return true;
}

void run(ddm::Configuration configuration) {
  ddm::prepareStart(&configuration);
  ddm::InProcessDriver driver(configuration);  // first: what it refuses must not leave a folder
  ddm::RunFolder folder(configuration);
  ddm::Progress progress(&std::cout, ::isatty(STDOUT_FILENO) != 0, configuration.experiment.trials,
                         configuration.evaluation.error_unit);
  for (const std::string& warning : folder.warnings()) progress.note("warning: " + warning);
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
