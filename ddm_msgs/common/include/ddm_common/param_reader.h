// Strict configuration reader: one options struct = one YAML block, every mistake reported at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <yaml-cpp/yaml.h>

#include <set>
#include <string>
#include <vector>

#include "ddm_common/param_value.h"

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

/// Reads options structs from the blocks of a YAML tree and remembers everything that is wrong.
///
/// An options struct has defaults, a `template <class Visitor> void visit(Visitor& visitor)` that
/// calls `visitor("key", member)` for each key, and `std::vector<std::string> problems() const`.
///
///   ParamReader reader = ParamReader::fromFiles({"model.yaml", "preset.yaml"});
///   const auto model = reader.read<ModelOptions>("model");
///   const auto mpc = reader.read<MpcOptions>("mpc");
///   reader.requireValid();  // not before all blocks are read: it reports them together
///
/// A block of another program of DDM is left alone, so that each program can be given the same files.
/// A block that no program knows is a mistake.
class ParamReader {
 public:
  /// @param root    blocks by name; nothing at all is an empty configuration
  /// @param source  where it comes from, for messages; may be empty
  /// @throws std::invalid_argument if root is neither a map nor empty
  explicit ParamReader(const YAML::Node& root, std::string source = "");

  /// Later files win, key by key inside a block; a list is replaced as a whole.
  ///
  /// @throws std::runtime_error with the path if a file cannot be read
  /// @throws std::invalid_argument with path and line if a file is not valid YAML, is not a map of
  ///         blocks, has more than one document, or gives a block or a key twice
  static ParamReader fromFiles(const std::vector<std::string>& paths);

  /// Accept a top-level name that belongs to others, like `image_transport`.
  void ignore(const std::string& block) { ignored_.insert(block); }

  /// Whether a block is given at all.
  bool has(const std::string& block) const;

  /// The values of a block, defaults where it is silent or wrong. Never throws for a bad value:
  /// unknown keys, wrong types and options.problems() are kept for requireValid().
  template <class Options>
  Options read(const std::string& block);

  /// Everything found wrong so far, unknown blocks included. Empty means valid.
  std::vector<std::string> problems() const;

  /// @throws std::invalid_argument with all problems(), one per line
  void requireValid() const;

 private:
  /// Notes that the block is known. Returns its keys, an empty map if it is not given.
  YAML::Node openBlock(const std::string& block);
  void reportUnknownKeys(const std::string& block, const YAML::Node& values,
                         const std::vector<std::string>& known_keys);
  void reportWrongType(const std::string& path, const YAML::Node& value,
                       const std::string& expected);
  void report(const std::string& problem);

  YAML::Node root_;
  std::string source_;
  std::set<std::string> read_;
  std::set<std::string> ignored_;
  std::vector<std::string> problems_;
};

template <class Options>
Options ParamReader::read(const std::string& block) {
  const YAML::Node values = openBlock(block);  // const: looking up a missing key must not add it
  std::vector<std::string> known_keys;
  auto take = [&](const std::string& key, auto& value) {
    known_keys.push_back(key);
    const YAML::Node given = values[key];
    if (given.IsDefined() && !parseValue(given, &value)) {
      reportWrongType(block + "/" + key, given, expectedType(&value));
    }
  };
  Options options;
  options.visit(take);
  reportUnknownKeys(block, values, known_keys);
  for (const std::string& problem : options.problems()) report(problem);
  return options;
}

}  // namespace ddm
