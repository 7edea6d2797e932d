// Merges the configuration files and the values of the user into one configuration.
// SPDX-License-Identifier: BSD-3-Clause
#include "resolution.h"

#include <ddm_common/config_blocks.h>
#include <ddm_common/option_checks.h>
#include <ddm_plant_plugin/plant_config.h>
#include <ddm_robot/robot_options.h>
#include <ddm_sim/plant.h>
#include <ros/package.h>

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <boost/filesystem.hpp>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

namespace fs = boost::filesystem;
namespace po = boost::program_options;

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

/// Path of ddm_launch/config/presets/NAME.yaml.
/// @throws std::invalid_argument listing the presets that exist, if there is no such file
std::string presetFile(const std::string& name) {
  const std::string path = packageFolder("ddm_launch") + "/config/presets";
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  }
  if (names.count(name) > 0) return path + "/" + name + ".yaml";
  throw std::invalid_argument("unknown preset '" + name + "': there are " + join(names, ", "));
}

/// Content of config/named.yaml: group -> name -> configuration.
YAML::Node namedConfigurations() {
  return readBlocks(packageFolder("ddm_launch") + "/config/named.yaml");
}

/// Reads a configuration, which is given by the path of a file or by its name GROUP/NAME.
/// @throws std::invalid_argument listing the names that exist, if there is no such file or name
Layer layerOf(const std::string& config) {
  if (fs::path(config).extension() == ".yaml" || fs::exists(config)) {
    return {config, readBlocks(config)};
  }
  const YAML::Node all = namedConfigurations();
  std::vector<std::string> known;
  for (const auto& group : all) {
    for (const auto& one : group.second) {
      known.push_back(group.first.Scalar() + "/" + one.first.Scalar());
      if (known.back() == config) return {config, one.second};
    }
  }
  throw std::invalid_argument("unknown configuration '" + config +
                              "': it is not a file, and there are " + join(known, ", "));
}

/// The parameter references, which hold and explain the default of each option.
std::vector<Layer> defaults() {
  std::vector<Layer> layers;
  for (const auto& [package, file] : {std::pair("ddm_sim", "config/sim.yaml"),
                                      {"ddm_model", "config/model.yaml"},
                                      {"ddm_mpc", "config/mpc.yaml"},
                                      {"ddm_launch", "methods/pilco/pilco.yaml"},
                                      {"ddm_launch", "config/experiment.yaml"}}) {
    layers.push_back(layerOf(packageFolder(package) + "/" + file));
  }
  return layers;
}

/// The value of BLOCK/KEY; empty if the key is missing or its value has another type.
template <class Value>
std::optional<Value> valueAt(const YAML::Node& blocks, const std::string& block,
                             const std::string& key) {
  Value value{};
  if (!hasKey(blocks, block, key) || !parseValue(blocks[block][key], &value)) return std::nullopt;
  return value;
}

/// The preset, plant or method that the last layer with such an entry names. The path of a plant's
/// file becomes absolute, because other programs may run in another folder.
std::string chosen(const std::string& kind, const std::vector<Layer>& layers) {
  std::string name;
  for (const Layer& layer : layers) {
    name = valueAt<std::string>(layer.blocks, "experiment", kind).value_or(name);
  }
  const bool of_file = kind == "plant" && namesPlantFile(name);
  return of_file ? fs::absolute(name).lexically_normal().string() : name;
}

/// Whether the user, the preset, the plant or another layer above the defaults gives BLOCK/KEY.
using Given = std::function<bool(const std::string& block, const std::string& key)>;

/// Sets a value that is derived from other values. If the block is not a map, nothing is set and
/// the reader reports the block.
void follow(const std::string& block, const std::string& key, const YAML::Node& value,
            YAML::Node* blocks) {
  const YAML::Node values = (*blocks)[block];
  if (!values.IsDefined() || values.IsMap()) (*blocks)[block][key] = YAML::Clone(value);
}

/// Motors of the robot, or of the plant if there is no robot. `max_torque` is written only there
/// (possibly in the plant's model file), and the blocks of the learner take it over.
struct Motors {
  YAML::Node limits;  ///< one limit for all motors, or a list with one limit per motor [N m]
  int count = 1;
};

/// Empty if robot or plant gives no valid limits; its own reader reports the problem.
std::optional<Motors> motorsOf(const YAML::Node& blocks) {
  if (blocks["robot"].IsDefined()) {
    if (!hasKey(blocks, "robot", "max_torque")) return std::nullopt;
    const YAML::Node limits = blocks["robot"]["max_torque"];
    if (!limits.IsSequence()) return Motors{limits, 1};
    if (limits.size() == 0) return std::nullopt;
    return Motors{limits, static_cast<int>(limits.size())};
  }
  try {
    ParamReader reader(blocks);
    const std::shared_ptr<const PlantPlugin> plant = readPlant(&reader);
    reader.requireValid();
    const YAML::Node block = plant->block();
    const YAML::Node limits = block["max_torque"];
    if (!limits.IsDefined()) return std::nullopt;
    return Motors{limits, limits.IsSequence() ? static_cast<int>(limits.size())
                                              : makePlant(*plant)->info().torqueDim()};
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// Derives `max_torque` and `torque_dim` of the learner from the motors.
/// @throws std::invalid_argument if a given torque_dim is not the number of motors
void shareMotors(const Given& given, YAML::Node* blocks) {
  const std::optional<Motors> motors = motorsOf(*blocks);
  if (!motors) return;
  for (const std::string learner : {"model", "mpc"}) {
    if (!given(learner, "max_torque")) follow(learner, "max_torque", motors->limits, blocks);
  }
  if (!given("controller", "torque_dim")) {
    follow("controller", "torque_dim", valueToYaml(motors->count), blocks);
    return;
  }
  const auto torque_dim = valueAt<int>(*blocks, "controller", "torque_dim");
  if (!torque_dim || torque_dim == motors->count) return;  // the reader reports other types
  throw std::invalid_argument(
      "controller/torque_dim must be the number of motors of robot or "
      "plant, " +
      std::to_string(motors->count) + ", got " + std::to_string(*torque_dim) + ": leave it out");
}

/// Derives the time step of the controller from robot or plant. In real time, a plan must be ready
/// before the next image, so that mpc/time_budget becomes half a time step.
/// @throws std::invalid_argument if the images of a robot are too far apart for mpc_node, which
///         aborts a trial if no image comes within controller/timeout
void shareTimeStep(const Given& given, YAML::Node* blocks) {
  const bool robot = (*blocks)["robot"].IsDefined();
  auto dt = valueAt<double>(*blocks, robot ? "robot" : "plant", "dt");
  if (robot && !dt) dt = RobotOptions().dt;  // robot.yaml may be read on the robot's computer only
  if (!dt) return;
  const auto timeout = valueAt<double>(*blocks, "controller", "timeout");
  if (robot && timeout && *timeout < 2.0 * *dt) {
    throw std::invalid_argument(textOf("controller/timeout must be at least 2 robot/dt, ",
                                       2.0 * *dt, " s, got ", *timeout,
                                       ": raise it, or the next image would count as missing"));
  }
  follow("controller", "dt", valueToYaml(*dt), blocks);
  const bool lockstep = valueAt<bool>(*blocks, "sim", "lockstep").value_or(true);
  if (given("mpc", "time_budget") || (!robot && lockstep)) return;
  follow("mpc", "time_budget", valueToYaml(0.5 * *dt), blocks);
}

}  // namespace

ResolvedConfiguration resolve(const Arguments& arguments) {
  std::vector<Layer> layers = defaults();
  for (const std::string& config : arguments.defaults) layers.push_back(layerOf(config));
  const auto num_defaults = static_cast<std::ptrdiff_t>(layers.size());
  std::vector<Layer> configs;
  for (const std::string& config : arguments.configs) configs.push_back(layerOf(config));
  const YAML::Node& values = arguments.values;

  std::vector<Layer> naming = layers;
  naming.insert(naming.end(), configs.begin(), configs.end());
  naming.push_back({"", values});
  std::map<std::string, std::string> names;
  for (const char* kind : {"preset", "plant", "method"}) names[kind] = chosen(kind, naming);
  const auto saved = std::find_if(configs.begin(), configs.end(), [](const Layer& config) {
    return config.blocks["version"].IsDefined();
  });
  if (saved != configs.end()) {
    // The file holds every value of its preset, plant and method. A different name would have no
    // effect.
    for (const auto& [kind, name] : names) {
      const std::string saved_name = chosen(kind, {*saved});
      if (name == saved_name) continue;
      throw std::invalid_argument(saved->file + " describes an experiment with the " + kind + " " +
                                  saved_name + ", not " + name + ": leave the " + kind +
                                  " out, or leave this file out and choose preset and values "
                                  "yourself");
    }
    layers.push_back(*saved);
  } else {
    layers.push_back(layerOf(presetFile(names["preset"])));
    layers.push_back(layerOf(plantFile(names["plant"])));
    const std::vector<std::string> methods = namesInGroup("method");
    if (std::count(methods.begin(), methods.end(), names["method"]) > 0) {
      layers.push_back(layerOf("method/" + names["method"]));
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
  if (values["start"].IsDefined() && resolved.blocks["start"].IsMap()) {
    resolved.blocks["start"].remove("checksums");  // they belong to the files that `values` replace
  }
  overlay(values, &resolved.blocks);
  follow("experiment", "plant", YAML::Node(names["plant"]), &resolved.blocks);
  layers.push_back({"", values});
  const Given given = [&](const std::string& block, const std::string& key) {
    return std::any_of(layers.begin() + num_defaults, layers.end(),
                       [&](const Layer& layer) { return hasKey(layer.blocks, block, key); });
  };
  shareMotors(given, &resolved.blocks);
  shareTimeStep(given, &resolved.blocks);
  return resolved;
}

std::vector<std::string> namesInGroup(const std::string& group) {
  std::vector<std::string> names;
  for (const auto& entry : namedConfigurations()[group]) names.push_back(entry.first.Scalar());
  return names;
}

po::options_description configurationOptions(const std::string& about, Arguments* arguments) {
  using Texts = std::vector<std::string>;
  po::options_description options(about + "\n\noptions");
  auto add = options.add_options();
  const auto add_first = [arguments](const Texts& configs) {
    arguments->configs.insert(arguments->configs.begin(), configs.begin(), configs.end());
  };
  const auto add_nuisances = [add_first](Texts names) {
    for (std::string& name : names) name = "nuisance/" + name;
    add_first(names);
  };
  const auto repeat = [add_first](const std::string& run) { add_first({run + "/config.yaml"}); };
  const auto set_all = [arguments](const Texts& all) {
    for (const std::string& one : all) setValue(one, &arguments->values);
  };
  add("preset", given<std::string>("experiment/preset", arguments),
      "name in ddm_launch/config/presets; otherwise that of the files, or paper");
  add("plant", given<std::string>("experiment/plant", arguments),
      "name in ddm_sim/config; PACKAGE/NAME: in config of another package; otherwise that of the "
      "files, or pendulum");
  add("config", po::value(&arguments->configs)->composing(),
      "YAML file, or GROUP/NAME of ddm_launch/config/named.yaml; repeatable, later ones win");
  add("nuisance", po::value<Texts>()->composing()->notifier(add_nuisances),
      ("a disturbance of camera or scene, the same as --config nuisance/NAME before others: " +
       join(namesInGroup("nuisance"), ", ") + "; repeatable")
          .c_str());
  add("repeat", po::value<std::string>()->notifier(repeat),
      "folder of an experiment whose configuration is repeated; later options win");
  add("set", po::value<Texts>()->composing()->notifier(set_all),
      "BLOCK/KEY=VALUE, wins over all files; a list is [A, B]; repeatable");
  return options;
}

}  // namespace ddm
