// run_experiment: Algorithm 1 in one process, without a ROS master.
// SPDX-License-Identifier: BSD-3-Clause
#include <ddm_model/solver_log.h>
#include <ros/time.h>
#include <unistd.h>

#include <boost/program_options.hpp>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "configuration.h"
#include "experiment.h"
#include "in_process_world.h"

namespace po = boost::program_options;

namespace {

constexpr int kUsageError = 2;

struct Arguments {
  std::string preset;
  std::string plant;
  int seed = 0;
  int trials = 15;
  std::string out;
  std::vector<std::string> configs;
};

/// @return false where --help was asked for and has been printed
bool parse(int argc, char** argv, Arguments* arguments) {
  po::options_description options(
      "Runs an experiment in one process: a random trial, then training, greedy evaluation and an\n"
      "epsilon-greedy trial in turn. The same command on the same folder resumes.\n\n"
      "usage: rosrun ddm_launch run_experiment --preset paper --plant pendulum --seed 1\n"
      "                                        --trials 15 --out DIR\n\noptions");
  options.add_options()("help,h", "show this text");
  options.add_options()("preset", po::value(&arguments->preset)->default_value("paper"),
                        "name in ddm_launch/config/presets");
  options.add_options()("plant", po::value(&arguments->plant)->default_value("pendulum"),
                        "name in ddm_sim/config");
  options.add_options()("seed", po::value(&arguments->seed)->default_value(0),
                        "fixes every random draw");
  options.add_options()("trials", po::value(&arguments->trials)->default_value(15),
                        "epsilon-greedy trials after the random one");
  options.add_options()("out", po::value(&arguments->out), "folder for the results");
  options.add_options()("config", po::value(&arguments->configs)->composing(),
                        "YAML file with what shall differ; repeatable, later files win");
  po::variables_map values;
  const po::positional_options_description no_positional;
  po::store(po::command_line_parser(argc, argv).options(options).positional(no_positional).run(),
            values);
  po::notify(values);
  if (values.count("help") > 0) {
    std::cout << options << "\n";
    return false;
  }
  if (arguments->out.empty()) throw po::error("--out DIR is missing: say where the results go");
  return true;
}

ddm::Configuration configure(const Arguments& arguments) {
  ddm::ParamReader reader = ddm::ParamReader::fromFiles(
      ddm::configurationFiles(arguments.preset, arguments.plant, arguments.configs));
  ddm::Configuration configuration = ddm::readConfiguration(&reader);
  configuration.experiment.preset = arguments.preset;
  configuration.experiment.plant = arguments.plant;
  configuration.experiment.seed = arguments.seed;
  configuration.experiment.trials = arguments.trials;
  configuration.experiment.runs = arguments.out;
  std::string problems;
  for (const std::string& problem : configuration.experiment.problems())
    problems += "\n - " + problem;
  if (!problems.empty()) throw std::invalid_argument("invalid options:" + problems);
  return configuration;
}

void run(const ddm::Configuration& configuration) {
  ddm::InProcessWorld world(configuration);  // first: what it refuses must not leave a folder
  ddm::RunFolder folder(configuration);
  ddm::Progress progress(&std::cout, ::isatty(STDOUT_FILENO) != 0, configuration.experiment.trials);
  for (const std::string& warning : folder.warnings()) progress.note("warning: " + warning);
  ddm::runExperiment(configuration, &world, &folder, &progress);
}

}  // namespace

int main(int argc, char** argv) {
  ros::Time::init();
  ddm::silenceSolverLog();
  Arguments arguments;
  ddm::Configuration configuration;
  try {
    if (!parse(argc, argv, &arguments)) return EXIT_SUCCESS;
    configuration = configure(arguments);
  } catch (const std::exception& e) {
    std::cerr << "run_experiment: " << e.what() << " (see --help)\n";
    return kUsageError;
  }
  try {
    run(configuration);
  } catch (const std::exception& e) {
    std::cerr << "\nrun_experiment: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
