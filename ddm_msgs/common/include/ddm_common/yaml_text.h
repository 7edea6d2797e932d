// Parses YAML from untrusted files, and prints YAML values in messages.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace ddm {

/// Parses a text with a single YAML document; null if there is no document. Limits the depth,
/// because yaml-cpp recurses for each level: before version 0.7, a deep document overflowed the
/// stack.
///
/// @param source  name of the file, for messages
/// @throws std::invalid_argument with source and line if the text is not valid YAML, has more than
///         one document or more than 20 levels, a list or map that contains itself, or a name or
///         value that is not UTF-8
YAML::Node parseYaml(const std::string& text, const std::string& source);

/// Refuses a text because of what is wrong at a position.
/// @throws std::invalid_argument with source and line
[[noreturn]] void refuseAt(const std::string& source, const YAML::Mark& mark,
                           const std::string& what);

/// Prints a value in one line of at most 120 characters, for a message.
std::string oneLine(const YAML::Node& node);

}  // namespace ddm
