// Command line of the programs that run an experiment in one process.
// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"

#include <stdexcept>

#include "method.h"

namespace ddm {

namespace po = boost::program_options;

namespace {

/// What --method says, otherwise the files.
std::string methodOf(const Arguments& arguments) {
  if (!arguments.method.empty()) return arguments.method;
  ParamReader reader = ParamReader::fromFiles(
      configurationFiles(arguments.preset, arguments.plant, arguments.configs));
  return reader.read<ExperimentOptions>("experiment").method;
}

}  // namespace

po::options_description configurationOptions(const std::string& about, Arguments* arguments) {
  po::options_description options(about + "\n\noptions");
  options.add_options()("preset", po::value(&arguments->preset)->default_value("paper"),
                        "name in ddm_launch/config/presets");
  options.add_options()("plant", po::value(&arguments->plant)->default_value("pendulum"),
                        "name in ddm_sim/config; PACKAGE/NAME: in config of another package");
  options.add_options()("nuisance", po::value(&arguments->nuisances)->composing(),
                        "name in ddm_launch/config/nuisances, what is wrong with the camera's "
                        "images: noise, brightness, clutter, thin_rod, delay or drops; repeatable");
  options.add_options()("config", po::value(&arguments->configs)->composing(),
                        "YAML file with what shall differ; repeatable, later files win");
  return options;
}

po::options_description commonOptions(const std::string& about, Arguments* arguments) {
  po::options_description options = configurationOptions(about, arguments);
  options.add_options()("seed", po::value(&arguments->seed)->default_value(0),
                        "fixes every random draw");
  options.add_options()("out", po::value(&arguments->out)->required(), "folder for the results");
  return options;
}

void addMethodOption(po::options_description* options, Arguments* arguments) {
  std::string about = "who learns and acts:";
  for (const MethodKind& kind : methodKinds()) about += "\n" + kind.name + ": " + kind.about;
  options->add_options()("method", po::value(&arguments->method), about.c_str());
}

ParamReader openConfiguration(const Arguments& arguments) {
  std::vector<std::string> configs;
  const std::string of_method = methodFile(methodOf(arguments));
  if (!of_method.empty()) configs.push_back(of_method);
  for (const std::string& name : arguments.nuisances) configs.push_back(nuisanceFile(name));
  configs.insert(configs.end(), arguments.configs.begin(), arguments.configs.end());
  return ParamReader::fromFiles(configurationFiles(arguments.preset, arguments.plant, configs));
}

Configuration readConfiguration(const Arguments& arguments, ParamReader* reader) {
  const std::string name = methodOf(arguments);
  const std::shared_ptr<const MethodSetup> method = methodKind(name).read(reader);
  Configuration configuration = readConfiguration(reader);
  configuration.method = method;
  configuration.experiment.method = name;
  configuration.experiment.preset = arguments.preset;
  configuration.experiment.plant = arguments.plant;
  configuration.experiment.seed = arguments.seed;
  configuration.experiment.runs = arguments.out;
  return configuration;
}

void requireValid(const ExperimentOptions& options) {
  std::string problems;
  for (const std::string& problem : options.problems()) problems += "\n - " + problem;
  if (!problems.empty()) throw std::invalid_argument("invalid options:" + problems);
}

}  // namespace ddm
