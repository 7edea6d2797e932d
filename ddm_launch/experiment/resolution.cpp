// How a configuration comes about: the files that make it up and what the user gave, in one order.
// SPDX-License-Identifier: BSD-3-Clause
#include "resolution.h"

#include <ddm_params/config_blocks.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_robot/robot_options.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/filesystem.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <set>
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

/// ddm_launch/config/FOLDER/NAME.yaml
/// @throws std::invalid_argument naming those that exist, if there is no such file
std::string chooseFile(const std::string& folder, const std::string& name,
                       const std::string& kind) {
  const std::string path = packageFolder("ddm_launch") + "/config/" + folder;
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  }
  if (names.count(name) > 0) return path + "/" + name + ".yaml";
  throw std::invalid_argument("unknown " + kind + " '" + name + "': there are " +
                              boost::algorithm::join(names, ", "));
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

/// BLOCK/KEY, if it is there and has this type.
template <class Value>
std::optional<Value> valueAt(const YAML::Node& blocks, const std::string& block,
                             const std::string& key) {
  Value value{};
  if (!hasKey(blocks, block, key) || !parseValue(blocks[block][key], &value)) return std::nullopt;
  return value;
}

/// Preset, plant or method: the last layer that names it decides.
std::string chosen(const std::string& key, const std::vector<Layer>& layers) {
  std::string name;
  for (const Layer& layer : layers) {
    name = valueAt<std::string>(layer.blocks, "experiment", key).value_or(name);
  }
  return name;
}

/// A plant's file is found from any folder.
std::string chosenPlant(const std::vector<Layer>& layers) {
  const std::string name = chosen("plant", layers);
  return namesPlantFile(name) ? fs::absolute(name).lexically_normal().string() : name;
}

/// A saved configuration holds every value of its plant: with another plant's name it would be a
/// mixture of the two.
void requirePlant(const std::string& plant, const Layer& config) {
  const std::string theirs = chosenPlant({config});
  if (theirs.empty() || theirs == plant || !config.blocks["plant"].IsDefined()) return;
  throw std::invalid_argument(config.file + " describes the plant " + theirs + ", not " + plant +
                              ": name that plant or none, or leave the file out and choose preset "
                              "and values yourself");
}

/// A saved configuration also holds every value of plant and camera, so a nuisance below it would
/// be lost without a word.
void requireNuisance(const std::string& name, const Layer& config) {
  if (!config.blocks["version"].IsDefined()) return;
  const std::string file = nuisanceFile(name);
  const YAML::Node nuisance = readBlocks(file);
  for (const auto& block : nuisance) {
    for (const auto& entry : block.second) {
      const std::string block_name = block.first.Scalar(), key = entry.first.Scalar();
      const auto there = valueAt<double>(config.blocks, block_name, key);
      if (!there || there == valueAt<double>(nuisance, block_name, key)) continue;
      throw std::invalid_argument(
          config.file + " describes an experiment without the nuisance " + name +
          ": leave the nuisance out, or give its file after that one, " + file);
    }
  }
}

/// A file that is given instead of another one has another checksum.
void forgetChecksums(const YAML::Node& values, YAML::Node* blocks) {
  if (hasKey(values, "start", "model") && hasKey(*blocks, "start", "model_id")) {
    (*blocks)["start"].remove("model_id");
  }
  if (hasKey(values, "start", "bags") && hasKey(*blocks, "start", "bag_ids")) {
    (*blocks)["start"].remove("bag_ids");
  }
}

/// Whether the user, the preset, the plant or another layer above the manuals gives BLOCK/KEY.
using Given = std::function<bool(const std::string& block, const std::string& key)>;

/// Sets a value that follows from others. The reader refuses a block that is not a map.
void follow(const std::string& block, const std::string& key, const YAML::Node& value,
            YAML::Node* blocks) {
  const YAML::Node values = (*blocks)[block];
  if (!values.IsDefined() || values.IsMap()) (*blocks)[block][key] = YAML::Clone(value);
}

/// A plant may know its motors where the YAML does not say all: how many they are, and in a model file
/// their limits. Whoever reads the plant after this reports what is wrong with it.
void askPlantForMotors(YAML::Node* blocks) {
  const bool known = !ownerOfMotors(*blocks).empty() && !hasKey(*blocks, "plant", "model");
  if ((*blocks)["robot"].IsDefined() || known) return;
  ParamReader reader(*blocks, "");
  std::shared_ptr<const PlantPlugin> plant;
  try {
    plant = readPlant(&reader);
  } catch (const std::exception&) {
    return;
  }
  if (!reader.problems().empty()) return;
  const YAML::Node limits = plant->block()["max_torque"];
  if (limits.IsDefined()) follow("plant", "max_torque", limits, blocks);
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
  if (owner == "plant" && !limits.IsSequence()) return;  // one number holds for all its motors
  const int num_motors = limits.IsSequence() ? static_cast<int>(limits.size()) : 1;
  if (!given("controller", "torque_dim")) {
    follow("controller", "torque_dim", valueToYaml(num_motors), blocks);
    return;
  }
  const auto torque_dim = valueAt<int>(*blocks, "controller", "torque_dim");
  if (!torque_dim || torque_dim == num_motors) return;  // the reader refuses anything else
  throw std::invalid_argument("controller/torque_dim must be the number of motors in " + owner +
                              "/max_torque, " + std::to_string(num_motors) + ", got " +
                              std::to_string(*torque_dim) + ": leave it out");
}

/// The controller's time step is that of what it controls. In real time a plan has to be there
/// before the next image.
void shareTimeStep(const Given& given, YAML::Node* blocks) {
  const bool robot = (*blocks)["robot"].IsDefined();
  auto dt = valueAt<double>(*blocks, robot ? "robot" : "plant", "dt");
  if (robot && !dt) dt = RobotOptions().dt;  // robot.yaml is read where robot_node runs
  if (!dt) return;
  follow("controller", "dt", valueToYaml(*dt), blocks);
  const bool lockstep = valueAt<bool>(*blocks, "sim", "lockstep").value_or(true);
  if (given("mpc", "time_budget") || (!robot && lockstep)) return;
  follow("mpc", "time_budget", valueToYaml(0.5 * *dt), blocks);
}

/// @throws std::invalid_argument if torques could reach a robot's motors without its guards
void requireOneWayToTheMotors(const YAML::Node& blocks) {
  if (!blocks["robot"].IsDefined()) return;
  if (!valueAt<bool>(blocks, "controller", "publish_effort").value_or(false)) return;
  throw std::invalid_argument(
      "controller/publish_effort must be false where robot_node guards the motors, got true: leave "
      "it out");
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
  const std::string plant = chosenPlant(naming);
  std::vector<std::string> files = {chooseFile("presets", chosen("preset", naming), "preset"),
                                    plantFile(plant)};
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
  for (const char* made_by : {"version", "renderer"}) resolved.blocks.remove(made_by);
  forgetChecksums(values, &resolved.blocks);
  overlay(values, &resolved.blocks);
  follow("experiment", "plant", YAML::Node(plant), &resolved.blocks);
  layers.push_back({"", values});
  const Given given = [&](const std::string& block, const std::string& key) {
    return std::any_of(layers.begin() + num_manuals, layers.end(),
                       [&](const Layer& layer) { return hasKey(layer.blocks, block, key); });
  };
  askPlantForMotors(&resolved.blocks);
  shareMotors(given, &resolved.blocks);
  shareTimeStep(given, &resolved.blocks);
  requireOneWayToTheMotors(resolved.blocks);
  return resolved;
}

std::string nuisanceFile(const std::string& name) {
  return chooseFile("nuisances", name, "nuisance");
}

std::string methodFile(const std::string& method) {
  const std::string file = packageFolder("ddm_launch") + "/config/methods/" + method + ".yaml";
  return !method.empty() && fs::exists(file) ? file : "";
}

boost::program_options::options_description configurationOptions(const std::string& about,
                                                                 Arguments* arguments) {
  boost::program_options::options_description options(about + "\n\noptions");
  auto add = options.add_options();
  add("preset", given<std::string>("experiment/preset", arguments),
      "name in ddm_launch/config/presets; otherwise that of the files, or paper");
  add("plant", given<std::string>("experiment/plant", arguments),
      "name in ddm_sim/config; PACKAGE/NAME: in config of another package; otherwise that of the "
      "files, or pendulum");
  add("nuisance", boost::program_options::value(&arguments->nuisances)->composing(),
      "name in ddm_launch/config/nuisances, what is wrong with the camera's images: noise, "
      "brightness, clutter, thin_rod, delay, drops, or with the scene of a model file: "
      "scene_camera, scene_colours; repeatable");
  add("config", boost::program_options::value(&arguments->configs)->composing(),
      "YAML file with overrides, or config.yaml of an experiment; repeatable, later files win");
  const auto set_all = [arguments](const std::vector<std::string>& all) {
    for (const std::string& one : all) setValue(one, &arguments->values);
  };
  add("set",
      boost::program_options::value<std::vector<std::string>>()->composing()->notifier(set_all),
      "BLOCK/KEY=VALUE, wins over all files; a list is [A, B]; repeatable");
  return options;
}

boost::program_options::options_description commonOptions(const std::string& about,
                                                          Arguments* arguments) {
  boost::program_options::options_description options = configurationOptions(about, arguments);
  auto add = options.add_options();
  add("seed", given<int>("experiment/seed", arguments),
      "fixes every random draw; otherwise that of the files, or 0");
  add("out", given<std::string>("experiment/runs", arguments)->required(),
      "folder for the results");
  return options;
}

}  // namespace ddm
