// How a configuration comes about: the files that make it up and what the user gave, in one order.
// SPDX-License-Identifier: BSD-3-Clause
#include "resolution.h"

#include <ddm_common/config_blocks.h>
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

using boost::algorithm::join;

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

/// ddm_launch/config/presets/NAME.yaml
/// @throws std::invalid_argument listing those that exist, if there is no such file
std::string presetFile(const std::string& name) {
  const std::string path = packageFolder("ddm_launch") + "/config/presets";
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  }
  if (names.count(name) > 0) return path + "/" + name + ".yaml";
  throw std::invalid_argument("unknown preset '" + name + "': there are " + join(names, ", "));
}

/// config/named.yaml: configurations by name, by group.
YAML::Node namedConfigurations() {
  return readBlocks(packageFolder("ddm_launch") + "/config/named.yaml");
}

/// A configuration by its name, or the file of this path.
Layer layerOf(const std::string& config) {
  if (fs::path(config).extension() == ".yaml" || fs::exists(config)) {
    return {config, readBlocks(config)};
  }
  return {config, namedConfiguration(config)};
}

/// Where each option has its default and its explanation.
std::vector<std::string> parameterReferences() {
  return {packageFolder("ddm_sim") + "/config/sim.yaml",
          packageFolder("ddm_model") + "/config/model.yaml",
          packageFolder("ddm_mpc") + "/config/mpc.yaml",
          packageFolder("ddm_launch") + "/methods/pilco/pilco.yaml",
          packageFolder("ddm_launch") + "/config/experiment.yaml"};
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

/// A saved configuration holds every value of its plant, preset and method, so another name for
/// one of them would not change the values.
/// @throws std::invalid_argument if the names differ
void requireSaved(const std::string& kind, const std::string& name, const std::string& saved,
                  const std::string& file) {
  if (name == saved) return;
  throw std::invalid_argument(file + " describes an experiment with the " + kind + " " + saved +
                              ", not " + name + ": leave the " + kind +
                              " out, or leave this file out and choose preset and values yourself");
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

/// Whether the user, the preset, the plant or another layer above the defaults gives BLOCK/KEY.
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
  std::vector<Layer> layers;
  for (const std::string& file : parameterReferences()) layers.push_back(layerOf(file));
  for (const std::string& config : arguments.defaults) layers.push_back(layerOf(config));
  const auto num_defaults = static_cast<std::ptrdiff_t>(layers.size());
  std::vector<Layer> configs;
  for (const std::string& config : arguments.configs) configs.push_back(layerOf(config));
  const YAML::Node& values = arguments.values;

  std::vector<Layer> naming = layers;
  naming.insert(naming.end(), configs.begin(), configs.end());
  naming.push_back({"", values});
  const std::string preset = chosen("preset", naming);
  const std::string plant = chosenPlant(naming);
  const std::string method = chosen("method", naming);
  const auto saved = std::find_if(configs.begin(), configs.end(), [](const Layer& config) {
    return config.blocks["version"].IsDefined();
  });
  if (saved != configs.end()) {
    requireSaved("preset", preset, chosen("preset", {*saved}), saved->file);
    requireSaved("plant", plant, chosenPlant({*saved}), saved->file);
    requireSaved("method", method, chosen("method", {*saved}), saved->file);
    layers.push_back(*saved);
  } else {
    for (const std::string& file : {presetFile(preset), plantFile(plant)}) {
      layers.push_back(layerOf(file));
    }
    const std::vector<std::string> methods = namesInGroup("method");
    if (std::count(methods.begin(), methods.end(), method) > 0) {
      layers.push_back(layerOf("method/" + method));
    }
  }
  for (auto config = configs.begin(); config != configs.end(); ++config) {
    if (config != saved) layers.push_back(*config);
  }

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
    return std::any_of(layers.begin() + num_defaults, layers.end(),
                       [&](const Layer& layer) { return hasKey(layer.blocks, block, key); });
  };
  askPlantForMotors(&resolved.blocks);
  shareMotors(given, &resolved.blocks);
  shareTimeStep(given, &resolved.blocks);
  requireOneWayToTheMotors(resolved.blocks);
  return resolved;
}

YAML::Node namedConfiguration(const std::string& name) {
  const YAML::Node all = namedConfigurations();
  const std::string::size_type slash = name.find('/');
  const std::string group = name.substr(0, slash);
  if (slash != std::string::npos && hasKey(all, group, name.substr(slash + 1))) {
    return all[group][name.substr(slash + 1)];
  }
  std::vector<std::string> known;
  for (const auto& entry : all) {
    for (const std::string& one : namesInGroup(entry.first.Scalar())) {
      if (!all[group].IsDefined() || group == entry.first.Scalar()) {
        known.push_back(entry.first.Scalar() + "/" + one);
      }
    }
  }
  throw std::invalid_argument("unknown configuration '" + name +
                              "': it is not a file, and there are " + join(known, ", "));
}

std::vector<std::string> namesInGroup(const std::string& group) {
  std::vector<std::string> names;
  for (const auto& entry : namedConfigurations()[group]) names.push_back(entry.first.Scalar());
  return names;
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
  add("config", boost::program_options::value(&arguments->configs)->composing(),
      "YAML file, or GROUP/NAME of ddm_launch/config/named.yaml; repeatable, later ones win");
  const auto first = [arguments](const std::vector<std::string>& configs) {
    arguments->configs.insert(arguments->configs.begin(), configs.begin(), configs.end());
  };
  const auto add_nuisances = [first](std::vector<std::string> names) {
    for (std::string& name : names) name = "nuisance/" + name;
    first(names);
  };
  add("nuisance",
      boost::program_options::value<std::vector<std::string>>()->composing()->notifier(
          add_nuisances),
      ("a disturbance of camera or scene, the same as --config nuisance/NAME before others: " +
       join(namesInGroup("nuisance"), ", ") + "; repeatable")
          .c_str());
  add("repeat",
      boost::program_options::value<std::string>()->notifier(
          [first](const std::string& run) { first({run + "/config.yaml"}); }),
      "folder of an experiment whose configuration is repeated; later options win");
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
