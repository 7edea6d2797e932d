// How a configuration comes about: the files that make it up and what the user gave, in one order.
// SPDX-License-Identifier: BSD-3-Clause
#include "resolution.h"

#include <ddm_params/config_blocks.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <functional>
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

/// A saved configuration also holds every value of plant and camera, so a nuisance below it would
/// be lost without a word.
void requireNuisance(const std::string& name, const Layer& config) {
  if (!config.blocks["version"].IsDefined()) return;
  const std::string file = nuisanceFile(name);
  for (const auto& block : readBlocks(file)) {
    const YAML::Node saved = config.blocks[block.first.Scalar()];
    if (!saved.IsDefined() || !saved.IsMap()) continue;
    for (const auto& entry : block.second) {
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

/// Whether the user, the preset, the plant or another layer above the manuals gives BLOCK/KEY.
using Given = std::function<bool(const std::string& block, const std::string& key)>;

/// Sets a value that follows from others. The reader refuses a block that is not a map.
void follow(const std::string& block, const std::string& key, const YAML::Node& value,
            YAML::Node* blocks) {
  const YAML::Node values = (*blocks)[block];
  if (!values.IsDefined() || values.IsMap()) (*blocks)[block][key] = YAML::Clone(value);
}

/// What a learner must know about its motors is written once: `max_torque` of the block `robot`,
/// without a robot of the block `plant`. A list has one entry per motor.
/// @throws std::invalid_argument if another number of motors is given
void shareMotors(const Given& given, YAML::Node* blocks) {
  const std::string owner = ownerOfMotors(*blocks);
  if (owner.empty()) return;
  const YAML::Node limits = (*blocks)[owner]["max_torque"];
  for (const std::string learner : {"model", "mpc"}) {
    if (!given(learner, "max_torque")) follow(learner, "max_torque", limits, blocks);
  }
  if (owner == "plant" && !limits.IsSequence())
    return;  // one number holds for all motors of a plant
  const int num_motors = limits.IsSequence() ? static_cast<int>(limits.size()) : 1;
  if (!given("controller", "torque_dim")) {
    follow("controller", "torque_dim", valueToYaml(num_motors), blocks);
    return;
  }
  int torque_dim = num_motors;
  parseValue((*blocks)["controller"]["torque_dim"], &torque_dim);  // else the reader refuses it
  if (torque_dim == num_motors) return;
  throw std::invalid_argument("controller/torque_dim must be the number of motors in " + owner +
                              "/max_torque, " + std::to_string(num_motors) + ", got " +
                              std::to_string(torque_dim) + ": leave it out");
}

/// In real time a plan has to be there before the next image.
void boundPlanning(const Given& given, YAML::Node* blocks) {
  if (given("mpc", "time_budget")) return;
  const bool robot = (*blocks)["robot"].IsDefined();
  bool lockstep = true;
  if (hasKey(*blocks, "sim", "lockstep")) parseValue((*blocks)["sim"]["lockstep"], &lockstep);
  const char* const clock = robot ? "robot" : "plant";
  double dt = 0.0;
  if ((!robot && lockstep) || !hasKey(*blocks, clock, "dt")) return;
  if (parseValue((*blocks)[clock]["dt"], &dt)) {
    follow("mpc", "time_budget", valueToYaml(0.5 * dt), blocks);
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
  layers.push_back({"", values});
  const Given given = [&](const std::string& block, const std::string& key) {
    return std::any_of(layers.begin() + num_manuals, layers.end(),
                       [&](const Layer& layer) { return hasKey(layer.blocks, block, key); });
  };
  shareMotors(given, &resolved.blocks);
  boundPlanning(given, &resolved.blocks);
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
