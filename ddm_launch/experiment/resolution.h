// How a configuration comes about: the files that make it up and what the user gave, in one order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_params/param_reader.h>
#include <ddm_params/param_value.h>
#include <ddm_params/tool.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {

/// What the user gave, and nothing else.
struct Arguments {
  std::vector<std::string> nuisances;      ///< names in ddm_launch/config/nuisances
  std::vector<std::string> configs;        ///< files; later ones win
  YAML::Node values{YAML::NodeType::Map};  ///< single values, blocks by name

  /// @param key  "block/key"
  template <class Value>
  void set(const std::string& key, const Value& value) {
    const std::string::size_type slash = key.find('/');
    values[key.substr(0, slash)][key.substr(slash + 1)] = valueToYaml(value);
  }
};

/// Blocks by name.
struct ResolvedConfiguration {
  YAML::Node blocks{YAML::NodeType::Map};
  std::string sources;  ///< the files, for messages

  ParamReader reader() const { return ParamReader(blocks, sources); }
};

/// The one place where a configuration is put together. Later layers win, key by key:
///
///   defaults, preset, plant, method, nuisances, configs, values
///
/// Where nothing above the defaults gives them, model/max_torque and mpc/max_torque are max_torque
/// of the robot, without a robot of the plant, which a model file may hold; controller/torque_dim is the number of motors that
/// it lists; and in real time mpc/time_budget is half a time step. Preset, plant and method are
/// those that `experiment` names in values, else in the last of the configs that names them, else
/// in the defaults. A file that names its plant and has a block `plant` describes that plant, so it
/// is refused for another one; a saved configuration is refused with a nuisance that it does not
/// have.
/// @throws std::invalid_argument if there is no such preset, plant or nuisance (those that exist
///         are named), if a config describes another plant or nuisance, or if controller/torque_dim
///         is not the number of motors
/// @throws std::runtime_error or std::invalid_argument as readBlocks(), for a file
ResolvedConfiguration resolve(const Arguments& arguments);

/// ddm_launch/config/nuisances/NAME.yaml: something that is wrong with the camera's images.
/// @throws std::invalid_argument naming those that exist, if there is no such nuisance
std::string nuisanceFile(const std::string& name);

/// ddm_launch/config/methods/NAME.yaml: values that a method needs; empty if it has no file.
std::string methodFile(const std::string& method);

/// A command line option whose value overrides `key` ("block/key"). It has no default: the
/// configuration files hold the defaults.
template <class Value>
boost::program_options::typed_value<Value>* given(const std::string& key, Arguments* arguments) {
  return boost::program_options::value<Value>()->notifier(
      [key, arguments](const Value& value) { arguments->set(key, value); });
}

/// The options that choose the files of a configuration.
/// @param about  text above the list of options
boost::program_options::options_description configurationOptions(const std::string& about,
                                                                 Arguments* arguments);

/// The same, --seed and --out.
boost::program_options::options_description commonOptions(const std::string& about,
                                                          Arguments* arguments);

}  // namespace ddm
