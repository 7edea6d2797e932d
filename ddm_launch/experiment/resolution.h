// Merges the configuration files and the values of the user into one configuration.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/param_reader.h>
#include <ddm_common/param_value.h>
#include <ddm_common/tool.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

namespace ddm {

/// Options from the command line or from a launch file.
struct Arguments {
  /// Configurations of a launch file, as `configs`, but preset, plant and method override them.
  std::vector<std::string> defaults;
  /// YAML files, or names GROUP/NAME in config/named.yaml. Later entries override earlier ones.
  std::vector<std::string> configs;
  YAML::Node values{YAML::NodeType::Map};  ///< single values: block -> key -> value

  /// @param key  "block/key"
  template <class Value>
  void set(const std::string& key, const Value& value) {
    const std::string::size_type slash = key.find('/');
    values[key.substr(0, slash)][key.substr(slash + 1)] = valueToYaml(value);
  }
};

/// A configuration after all layers have been merged.
struct ResolvedConfiguration {
  YAML::Node blocks{YAML::NodeType::Map};  ///< blocks by name
  std::string sources;                     ///< list of the merged files, for error messages

  ParamReader reader() const { return ParamReader(blocks, sources); }
};

/// Merges all layers of a configuration. All programs call this function. Later layers override
/// earlier ones, key by key:
///
///   defaults, preset, plant, method, configs, values
///
/// The defaults are the parameter references, followed by the defaults of a launch file.
///
/// If one of the configs is the saved configuration of an experiment (--repeat RUN), it replaces
/// the layers preset, plant and method. Otherwise the block `experiment` names preset, plant and
/// method. The values are searched first, then the configs from last to first, then the defaults.
///
/// Three values are derived if no layer above the defaults gives them:
///  * model/max_torque and mpc/max_torque are robot/max_torque. Without a robot they are the
///    max_torque of the plant, which may come from its model file;
///  * controller/torque_dim is the number of motors of robot or plant;
///  * mpc/time_budget is half a time step if the plant runs in real time.
/// @throws std::invalid_argument if there is no such preset, plant or named configuration (the
///         message lists those that exist), if a saved configuration has another preset, plant or
///         method, if controller/torque_dim is not the number of motors, or if
///         controller/timeout is too short for robot/dt
/// @throws std::runtime_error or std::invalid_argument if a file cannot be read, see readBlocks()
ResolvedConfiguration resolve(const Arguments& arguments);

/// The names in a group of named configurations; empty if there is no such group.
std::vector<std::string> namesInGroup(const std::string& group);

/// A command line option that sets `key` ("block/key"). The option has no default, because the
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

}  // namespace ddm
