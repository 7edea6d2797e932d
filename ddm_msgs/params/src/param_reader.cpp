// Strict configuration reader: the collection of problems.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_params/param_reader.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "ddm_params/config_blocks.h"
#include "ddm_params/yaml_text.h"

namespace ddm {
namespace {

namespace fs = std::filesystem;

/// The blocks of all packages: those in the manuals that ddm_register_manuals() of
/// ddm_msgs/cmake/ddm_build.cmake has registered, in each workspace that was sourced.
std::set<std::string> registeredBlocks() {
  std::set<std::string> blocks;
  const char* const workspaces = std::getenv("CMAKE_PREFIX_PATH");
  std::istringstream prefixes(workspaces == nullptr ? "" : workspaces);
  std::error_code ignored;  // a workspace without manuals
  for (std::string prefix, block; std::getline(prefixes, prefix, ':');) {
    for (const auto& package : fs::directory_iterator(prefix + "/share/ddm_params", ignored)) {
      std::ifstream names(package.path());
      while (names >> block) blocks.insert(block);
    }
  }
  return blocks;
}

/// Number of characters to insert, delete or replace to turn one word into the other.
std::size_t editDistance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// " (did you mean horizon? known keys: horizon, epsilon)"
template <class Names>
std::string hint(const std::string& name, const char* kind, const Names& known) {
  std::string list, nearest;
  std::size_t nearest_distance = std::min<std::size_t>(3, (name.size() + 1) / 2);
  for (const std::string& candidate : known) {
    list += (list.empty() ? "" : ", ") + candidate;
    const std::size_t distance = editDistance(name, candidate);
    if (distance < nearest_distance) {
      nearest_distance = distance;
      nearest = candidate;
    }
  }
  const std::string question = nearest.empty() ? "" : "did you mean " + nearest + "? ";
  return " (" + question + "known " + kind + ": " + list + ")";
}

}  // namespace

ParamReader::ParamReader(const YAML::Node& root, std::string source) : source_(std::move(source)) {
  if (root.IsDefined() && !root.IsNull() && !root.IsMap()) {
    throw std::invalid_argument("the configuration must be a map of blocks, got " + oneLine(root));
  }
  root_ = root.IsDefined() && root.IsMap() ? root : YAML::Node(YAML::NodeType::Map);
}

ParamReader ParamReader::fromFiles(const std::vector<std::string>& paths) {
  YAML::Node merged(YAML::NodeType::Map);
  std::string source;
  for (const std::string& path : paths) {
    overlay(readBlocks(path), &merged);
    source += (source.empty() ? "" : ", ") + path;
  }
  return ParamReader(merged, source);
}

bool ParamReader::has(const std::string& block) const {
  const YAML::Node& root = root_;
  return root[block].IsDefined();
}

YAML::Node ParamReader::openBlock(const std::string& block) {
  read_.insert(block);
  const YAML::Node& root = root_;
  const YAML::Node values = root[block];
  if (values.IsDefined() && values.IsMap()) return values;
  if (values.IsDefined() && !values.IsNull()) {
    report(block + " must be a block of keys, got " + oneLine(values));
  }
  return YAML::Node(YAML::NodeType::Map);
}

void ParamReader::reportUnknownKeys(const std::string& block, const YAML::Node& values,
                                    const std::vector<std::string>& known_keys) {
  for (const auto& entry : values) {
    const std::string key = oneLine(entry.first);
    if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      report("unknown key " + block + "/" + key + hint(key, "keys", known_keys));
    }
  }
}

void ParamReader::reportWrongType(const std::string& path, const YAML::Node& value,
                                  const std::string& expected) {
  report(path + " must be " + expected + ", got " + oneLine(value));
}

void ParamReader::report(const std::string& problem) {
  // A block may be read by two parts of one program.
  if (std::find(problems_.begin(), problems_.end(), problem) == problems_.end()) {
    problems_.push_back(problem);
  }
}

std::vector<std::string> ParamReader::problems() const {
  std::vector<std::string> out = problems_;
  std::set<std::string> known = registeredBlocks();
  const char* const remedy = known.empty() ? ": source the setup.bash of its workspace" : "";
  known.insert(read_.begin(), read_.end());
  for (const auto& entry : root_) {
    const std::string name = oneLine(entry.first);
    if (name == "version") continue;  // a saved configuration says which code made it
    if (known.count(name) + ignored_.count(name) == 0) {
      out.push_back("unknown block " + name + hint(name, "blocks", known) + remedy);
    }
  }
  return out;
}

void ParamReader::requireValid() const {
  const std::vector<std::string> all = problems();
  if (all.empty()) return;
  std::string message =
      "invalid configuration" + (source_.empty() ? "" : " (" + source_ + ")") + ":";
  for (const std::string& problem : all) message += "\n - " + problem;
  throw std::invalid_argument(message);
}

}  // namespace ddm
