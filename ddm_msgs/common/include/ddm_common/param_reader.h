// Strict configuration reader: one YAML block per struct, all mistakes reported at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <set>
#include <string>
#include <vector>

#include "ddm_common/param_value.h"
#include "ddm_common/yaml_text.h"

namespace ddm {

/// Effective values of a block, for printing and saving, in the order of the struct's visit().
template <class Options>
YAML::Node toYaml(const Options& options) {
  YAML::Node out(YAML::NodeType::Map);
  auto write = [&out](const std::string& key, const auto& value) { out[key] = valueToYaml(value); };
  Options copy = options;  // visit() is not const: the same function also reads
  copy.visit(write);
  return out;
}

/// Reads options structs from the blocks of a YAML tree and collects all problems.
///
/// An options struct has defaults, a `template <class Visitor> void visit(Visitor& visitor)` that
/// calls `visitor("key", member)` for each key, and `std::vector<std::string> problems() const`.
///
///   ParamReader reader = ParamReader::fromFiles({"model.yaml", "preset.yaml"});
///   const auto model = reader.read<ModelOptions>("model");
///   const auto mpc = reader.read<MpcOptions>("mpc");
///   reader.requireValid();  // call it last: it reports the problems of all blocks together
///
/// Blocks of other DDM programs are ignored, so that all programs can use the same files. A block
/// that no DDM program has is a mistake.
class ParamReader {
 public:
  /// @param root    blocks by name; a null node is an empty configuration
  /// @param source  origin of the blocks, for messages; may be empty
  /// @throws std::invalid_argument if root is neither a map nor empty
  explicit ParamReader(const YAML::Node& root, std::string source = "");

  /// Reads and merges files: later files replace values of earlier files key by key. A list is
  /// replaced as a whole.
  ///
  /// @throws std::runtime_error with the path if a file cannot be read
  /// @throws std::invalid_argument with path and line if a file is not valid YAML, is not a map of
  ///         blocks, has more than one document, or gives a block or a key twice
  static ParamReader fromFiles(const std::vector<std::string>& paths);

  /// Accepts a top-level name that is not a block of DDM, such as `image_transport`.
  void ignore(const std::string& block) { ignored_.insert(block); }

  /// Whether the configuration contains the block.
  bool has(const std::string& block) const;

  /// Reads a block. Keys that are missing or invalid keep their default values. Never throws for an
  /// invalid value: unknown keys, wrong types and options.problems() are collected for
  /// requireValid().
  template <class Options>
  Options read(const std::string& block);

  /// All problems found so far, including unknown blocks. Empty if the configuration is valid.
  std::vector<std::string> problems() const;

  /// @throws std::invalid_argument with all problems(), one per line
  void requireValid() const;

 private:
  /// Marks the block as known and returns its keys; an empty map if the configuration does not
  /// contain the block.
  YAML::Node openBlock(const std::string& block);
  void report(const std::string& problem);
  void reportUnknownKeys(const std::string& block, const YAML::Node& values,
                         const std::vector<std::string>& known_keys);

  YAML::Node root_;
  std::string source_;
  std::set<std::string> read_;
  std::set<std::string> ignored_;
  std::vector<std::string> problems_;
};

template <class Options>
Options ParamReader::read(const std::string& block) {
  // The node is const because looking up a missing key must not add it.
  const YAML::Node values = openBlock(block);
  std::vector<std::string> known_keys;
  auto take = [&](const std::string& key, auto& value) {
    known_keys.push_back(key);
    const YAML::Node given = values[key];
    if (given.IsDefined() && !parseValue(given, &value)) {
      report(block + "/" + key + " must be " + expectedType(&value) + ", got " + oneLine(given));
    }
  };
  Options options;
  options.visit(take);
  reportUnknownKeys(block, values, known_keys);
  for (const std::string& problem : options.problems()) report(problem);
  return options;
}

}  // namespace ddm
