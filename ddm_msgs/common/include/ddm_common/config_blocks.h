// Blocks of a configuration: read from a file, laid over those of another.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// The blocks of a configuration file by name; an empty map if the file holds only comments.
/// Relative paths of files that the configuration names (model file, goal picture,
/// bags, plant file) start at the folder of the configuration, and are returned as absolute ones.
///
/// @throws std::runtime_error with the path if the file cannot be read
/// @throws std::invalid_argument with path and line if it is not valid YAML, is not a map of
///         blocks, has more than one document, or gives a block or a key twice
YAML::Node readBlocks(const std::string& path);

/// The blocks of a text.
/// @param source  for messages
/// @throws std::invalid_argument as readBlocks()
YAML::Node parseBlocks(const std::string& text, const std::string& source);

/// Lays blocks over others: `above` wins, key by key inside a block; a list is replaced as a whole,
/// and a block without a value changes nothing.
void overlay(const YAML::Node& above, YAML::Node* below);

/// Sets one value from the command line, an option --set BLOCK/KEY=VALUE. A list is [A, B]. With an empty
/// value nothing is set: launch files pass an argument that was not given like that.
/// @throws std::invalid_argument if the text is of another form
void setValue(const std::string& text, YAML::Node* blocks);

/// Whether a block is a map that gives this key.
bool hasKey(const YAML::Node& blocks, const std::string& block, const std::string& key);

/// The block whose `max_torque` says which motors there are, for all who learn or act: `robot`,
/// without a robot `plant`; empty if that block does not say, or has an empty list.
std::string ownerOfMotors(const YAML::Node& blocks);

}  // namespace ddm
