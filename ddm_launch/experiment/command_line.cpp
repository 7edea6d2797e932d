// Command line of the programs that take a configuration.
// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.h"

namespace ddm {

namespace po = boost::program_options;

po::options_description configurationOptions(const std::string& about, Arguments* arguments) {
  po::options_description options(about + "\n\noptions");
  auto add = options.add_options();
  add("preset", given<std::string>("experiment/preset", arguments),
      "name in ddm_launch/config/presets; otherwise that of the files, or paper");
  add("plant", given<std::string>("experiment/plant", arguments),
      "name in ddm_sim/config; PACKAGE/NAME: in config of another package; otherwise that of the "
      "files, or pendulum");
  add("nuisance", po::value(&arguments->nuisances)->composing(),
      "name in ddm_launch/config/nuisances, what is wrong with the camera's images: noise, "
      "brightness, clutter, thin_rod, delay, drops, or with the scene of a model file: "
      "scene_background, scene_camera, scene_colours, scene_light; repeatable");
  add("config", po::value(&arguments->configs)->composing(),
      "YAML file with overrides, or config.yaml of an experiment; repeatable, later files win");
  return options;
}

po::options_description commonOptions(const std::string& about, Arguments* arguments) {
  po::options_description options = configurationOptions(about, arguments);
  auto add = options.add_options();
  add("seed", given<int>("experiment/seed", arguments),
      "fixes every random draw; otherwise that of the files, or 0");
  add("out", given<std::string>("experiment/runs", arguments)->required(),
      "folder for the results");
  return options;
}

}  // namespace ddm
