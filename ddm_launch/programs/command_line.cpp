// Command line of the programs that run an experiment in one process.
// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"

#include "method_kinds.h"

namespace ddm {

namespace po = boost::program_options;

po::options_description configurationOptions(const std::string& about, Arguments* arguments) {
  po::options_description options(about + "\n\noptions");
  options.add_options()("preset", given<std::string>("experiment/preset", arguments),
                        "name in ddm_launch/config/presets; otherwise that of the files, or paper");
  options.add_options()("plant", given<std::string>("experiment/plant", arguments),
                        "name in ddm_sim/config; PACKAGE/NAME: in config of another package; "
                        "otherwise that of the files, or pendulum");
  options.add_options()("nuisance", po::value(&arguments->nuisances)->composing(),
                        "name in ddm_launch/config/nuisances, what is wrong with the camera's "
                        "images: noise, brightness, clutter, thin_rod, delay or drops; repeatable");
  options.add_options()("config", po::value(&arguments->configs)->composing(),
                        "YAML file with overrides, or config.yaml of an experiment; repeatable, "
                        "later files win");
  return options;
}

po::options_description commonOptions(const std::string& about, Arguments* arguments) {
  po::options_description options = configurationOptions(about, arguments);
  options.add_options()("seed", given<int>("experiment/seed", arguments),
                        "fixes every random draw; otherwise that of the files, or 0");
  options.add_options()("out", given<std::string>("experiment/runs", arguments)->required(),
                        "folder for the results");
  return options;
}

void addMethodOption(po::options_description* options, Arguments* arguments) {
  std::string about = "who learns and acts:";
  for (const MethodKind& kind : methodKinds()) about += "\n" + kind.name + ": " + kind.about;
  options->add_options()("method", given<std::string>("experiment/method", arguments),
                         about.c_str());
}

Configuration readWithMethod(ParamReader* reader) {
  ParamReader ahead = *reader;  // a copy: its problems are reported with all others
  const std::string name = ahead.read<ExperimentOptions>("experiment").method;
  const std::shared_ptr<const MethodSetup> method = methodKind(name).read(reader);
  Configuration configuration = readConfiguration(reader);
  configuration.method = method;
  return configuration;
}

}  // namespace ddm
