// config.yaml of a folder of results, to compare with what shall run there.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <string>

namespace ddm {

/// Values of a configuration, as YAML, by "block/key".
using ConfigurationValues = std::map<std::string, std::string>;

struct SavedConfiguration {
  ConfigurationValues values;
  std::string version = "?";  ///< of the code that saved it
};

/// @param configuration  blocks by name; what is no block does not count
ConfigurationValues keysOf(const YAML::Node& configuration);

/// @param source  file, for messages
/// @throws std::invalid_argument with source and line if the text is not YAML of blocks by name
SavedConfiguration readConfigurationText(const std::string& text, const std::string& source);

/// The differences with which an experiment must not go on, a line each; empty: none. What is
/// chosen by looking at the robot (crop and goal) may change until the first trial is finished.
std::string differencesOf(const ConfigurationValues& there, const ConfigurationValues& here,
                          bool trial_finished);

}  // namespace ddm
