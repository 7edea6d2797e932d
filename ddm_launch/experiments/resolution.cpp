// How a configuration comes about: the files that make it up and what the user gave, in one order.
// SPDX-License-Identifier: BSD-3-Clause
#include "resolution.h"

#include <ddm_params/config_blocks.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <optional>
#include <stdexcept>

namespace ddm {
namespace {

namespace fs = boost::filesystem;

struct Layer {
  std::string file;
  YAML::Node blocks;
};

std::string packageFolder(const std::string& package) {
  const std::string path = ros::package::getPath(package);
  if (path.empty()) {
    throw std::invalid_argument("package " + package +
                                " cannot be found: source devel/setup.bash of your workspace");
  }
  return path;
}

/// FOLDER/NAME.yaml
/// @throws std::invalid_argument naming those that exist, if there is no such file
std::string chooseFile(const std::string& folder, const std::string& name,
                       const std::string& kind) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return folder + "/" + name + ".yaml";
  }
  std::string known;
  for (const std::string& other : names) known += (known.empty() ? "" : ", ") + other;
  throw std::invalid_argument("unknown " + kind + " '" + name + "': there are " + known);
}

std::vector<std::string> manuals() {
  const std::string launch = packageFolder("ddm_launch") + "/config";
  return {packageFolder("ddm_sim") + "/config/sim.yaml",
          packageFolder("ddm_model") + "/config/model.yaml",
          packageFolder("ddm_mpc") + "/config/mpc.yaml",
          packageFolder("ddm_mpc") + "/config/pilco.yaml",
          launch + "/experiment.yaml",
          launch + "/pilco.yaml"};
}

/// A name in the block `experiment`, if it is there.
std::optional<std::string> nameIn(const YAML::Node& blocks, const std::string& key) {
  const YAML::Node experiment = blocks["experiment"];
  if (!experiment.IsDefined() || !experiment.IsMap()) return {};
  const YAML::Node name = experiment[key];
  if (!name.IsDefined() || !name.IsScalar()) return {};
  return name.Scalar();
}

/// Preset, plant or method: the last layer that names it decides.
std::string chosen(const std::string& key, const std::vector<Layer>& layers) {
  std::string name;
  for (const Layer& layer : layers) name = nameIn(layer.blocks, key).value_or(name);
  return name;
}

/// A saved configuration holds every value of its plant: with another plant's name it would be a
/// mixture of the two.
void requirePlant(const std::string& plant, const Layer& config) {
  const std::string theirs = nameIn(config.blocks, "plant").value_or(plant);
  if (theirs == plant || !config.blocks["plant"].IsDefined()) return;
  throw std::invalid_argument(config.file + " describes the plant " + theirs + ", not " + plant +
                              ": name that plant or none, or leave the file out and choose preset "
                              "and values yourself");
}

/// A saved configuration also holds every value of its camera, so a nuisance below it would be lost
/// without a word.
void requireNuisance(const std::string& name, const Layer& config) {
  const YAML::Node saved = config.blocks["camera"];
  if (!config.blocks["version"].IsDefined() || !saved.IsDefined() || !saved.IsMap()) return;
  const std::string file = nuisanceFile(name);
  const YAML::Node nuisance = readBlocks(file);
  for (const auto& entry : nuisance["camera"]) {
    double here = 0.0, there = 0.0;
    const YAML::Node value = saved[entry.first.Scalar()];
    if (!value.IsDefined() || !parseValue(value, &there) || !parseValue(entry.second, &here) ||
        here == there) {
      continue;
    }
    throw std::invalid_argument(
        config.file + " describes an experiment without the nuisance " + name +
        ": leave the nuisance out, or give its file after that one, " + file);
  }
}

/// A file that is given instead of another one has another checksum.
void forgetChecksums(const YAML::Node& values, YAML::Node* blocks) {
  const YAML::Node start = values["start"];
  if (!start.IsDefined() || !start.IsMap()) return;
  YAML::Node below = (*blocks)["start"];
  if (!below.IsDefined() || !below.IsMap()) return;
  if (start["model"].IsDefined()) below.remove("model_id");
  if (start["bags"].IsDefined()) below.remove("bag_ids");
}

bool has(const YAML::Node& blocks, const std::string& block, const std::string& key) {
  const YAML::Node values = blocks[block];
  return values.IsDefined() && values.IsMap() && values[key].IsDefined();
}

/// In real time a plan has to be there before the next image.
void boundPlanning(YAML::Node* blocks) {
  const bool robot = (*blocks)["robot"].IsDefined();
  bool lockstep = true;
  if (has(*blocks, "sim", "lockstep")) parseValue((*blocks)["sim"]["lockstep"], &lockstep);
  const char* const clock = robot ? "robot" : "plant";
  double dt = 0.0;
  if ((!robot && lockstep) || !has(*blocks, clock, "dt")) return;
  if (parseValue((*blocks)[clock]["dt"], &dt)) {
    (*blocks)["mpc"]["time_budget"] = valueToYaml(0.5 * dt);
  }
}

}  // namespace

ResolvedConfiguration resolve(const Arguments& arguments) {
  const auto layersOf = [](const std::vector<std::string>& files) {
    std::vector<Layer> layers;
    for (const std::string& file : files) layers.push_back({file, readBlocks(file)});
    return layers;
  };
  std::vector<Layer> layers = layersOf(manuals());
  const auto num_manuals = static_cast<std::ptrdiff_t>(layers.size());
  const std::vector<Layer> configs = layersOf(arguments.configs);
  const YAML::Node& values = arguments.values;

  std::vector<Layer> naming = layers;
  naming.insert(naming.end(), configs.begin(), configs.end());
  naming.push_back({"", values});
  const std::string plant = chosen("plant", naming);
  std::vector<std::string> files = {presetFile(chosen("preset", naming)), plantFile(plant)};
  const std::string of_method = methodFile(chosen("method", naming));
  if (!of_method.empty()) files.push_back(of_method);
  for (const std::string& name : arguments.nuisances) files.push_back(nuisanceFile(name));
  for (const Layer& config : configs) {
    requirePlant(plant, config);
    for (const std::string& name : arguments.nuisances) requireNuisance(name, config);
  }
  for (const Layer& layer : layersOf(files)) layers.push_back(layer);
  layers.insert(layers.end(), configs.begin(), configs.end());

  ResolvedConfiguration resolved;
  for (const Layer& layer : layers) {
    overlay(layer.blocks, &resolved.blocks);
    resolved.sources += (resolved.sources.empty() ? "" : ", ") + layer.file;
  }
  resolved.blocks.remove("version");  // of the code that saved a file
  forgetChecksums(values, &resolved.blocks);
  overlay(values, &resolved.blocks);
  const bool budget_given =
      has(values, "mpc", "time_budget") ||
      std::any_of(layers.begin() + num_manuals, layers.end(),
                  [](const Layer& layer) { return has(layer.blocks, "mpc", "time_budget"); });
  if (!budget_given) boundPlanning(&resolved.blocks);
  return resolved;
}

std::string presetFile(const std::string& preset) {
  return chooseFile(packageFolder("ddm_launch") + "/config/presets", preset, "preset");
}

std::string nuisanceFile(const std::string& name) {
  return chooseFile(packageFolder("ddm_launch") + "/config/nuisances", name, "nuisance");
}

std::string methodFile(const std::string& method) {
  const std::string file = packageFolder("ddm_launch") + "/config/methods/" + method + ".yaml";
  return !method.empty() && fs::exists(file) ? file : "";
}

}  // namespace ddm
