// How a configuration comes about: the files that make it up and what the user gave, in one order.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <ddm_common/param_value.h>
#include <ddm_common/tool.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {

/// What the user gave, and nothing else.
struct Arguments {
  std::vector<std::string> defaults;  ///< as configs, but of a launch file: preset and plant win
  std::vector<std::string> configs;   ///< GROUP/NAME of config/named.yaml, or files; later ones win
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
///   defaults, preset, plant, method, configs, values
///
/// The defaults are those of the parameter references, then those of a launch file.
///
/// A saved configuration among the configs (--repeat RUN) takes the place of preset, plant and
/// method. Otherwise preset, plant and method are those that `experiment` names in values, else in
/// the last of the configs that names them, else in the defaults.
///
/// Where nothing above the defaults gives them, model/max_torque and mpc/max_torque are max_torque
/// of the robot, without a robot of the plant, which a model file may hold; controller/torque_dim is
/// the number of motors in that list; and in real time mpc/time_budget is half a time step.
/// @throws std::invalid_argument if there is no such preset, plant or named configuration (the
///         message lists those that exist), if a saved configuration has another preset, plant or
///         method, or if controller/torque_dim is not the number of motors
/// @throws std::runtime_error or std::invalid_argument as readBlocks(), for a file
ResolvedConfiguration resolve(const Arguments& arguments);

/// The names in a group of named configurations; empty if there is no such group.
std::vector<std::string> namesInGroup(const std::string& group);

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
