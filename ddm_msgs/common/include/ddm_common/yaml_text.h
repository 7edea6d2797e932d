// YAML from a file of unknown origin, and its values in messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// The one document of a text; null if there is none. yaml-cpp calls itself for each level; before
/// 0.7 it did so until the stack ended, and the program.
///
/// @param source  file, for messages
/// @throws std::invalid_argument with source and line if the text is not valid YAML, has more than
///         one document or more than 20 levels, a list or map that contains itself, or a name or
///         value that is not UTF-8
YAML::Node parseYaml(const std::string& text, const std::string& source);

/// A value in one line of at most 120 characters, for a message.
std::string oneLine(const YAML::Node& node);

}  // namespace ddm
