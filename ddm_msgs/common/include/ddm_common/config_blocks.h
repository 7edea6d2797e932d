// Reads the blocks of configuration files and merges them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// Reads the blocks of a configuration file by name; an empty map if the file contains only
/// comments. Relative paths in the configuration (model file, goal image, bags, plant file) are
/// relative to the folder of the configuration file and are returned as absolute paths.
///
/// @throws std::runtime_error with the path if the file cannot be read
/// @throws std::invalid_argument with path and line if it is not valid YAML, is not a map of
///         blocks, has more than one document, or gives a block or a key twice
YAML::Node readBlocks(const std::string& path);

/// Reads the blocks of a text.
/// @param source  name of the text, for messages
/// @throws std::invalid_argument as readBlocks()
YAML::Node parseBlocks(const std::string& text, const std::string& source);

/// Merges blocks: values of `above` replace those of `below` key by key. A list is replaced as a
/// whole, and a block without a value changes nothing.
void overlay(const YAML::Node& above, YAML::Node* below);

/// Sets one value from a command line option --set BLOCK/KEY=VALUE. A list is written [A, B]. An
/// empty value sets nothing, because launch files pass arguments that the user did not give as
/// empty values.
/// @throws std::invalid_argument if the text has another form
void setValue(const std::string& text, YAML::Node* blocks);

/// Whether a block is a map that contains this key.
bool hasKey(const YAML::Node& blocks, const std::string& block, const std::string& key);

/// Sets max_torque of a learner to that of the robot or plant in `blocks`, unless `blocks` gives it.
/// @param learner  block with the key max_torque: "model" or "mpc"
/// @return the parameter that gives the limits, such as "plant/max_torque"; "the default" if there
///         is none
/// @throws std::invalid_argument if only the model file of the plant gives the limits
std::string takeOverLimits(const std::string& learner, YAML::Node* blocks);

}  // namespace ddm
