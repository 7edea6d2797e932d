// Reads the blocks of configuration files and merges them.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_common/config_blocks.h"

#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "ddm_common/plain_file.h"
#include "ddm_common/yaml_text.h"

namespace ddm {
namespace {

constexpr std::size_t kMaxBytes = 1000000;  // largest size of a configuration file

void requireUniqueKeys(const YAML::Node& map, const std::string& path) {
  std::set<std::string> seen;
  for (const auto& entry : map) {
    if (!entry.first.IsScalar()) refuseAt(path, entry.first.Mark(), "a key must be a plain name");
    if (!seen.insert(entry.first.Scalar()).second) {
      refuseAt(path, entry.first.Mark(), "'" + entry.first.Scalar() + "' is given twice");
    }
  }
}

/// Keys whose values are paths of files.
constexpr std::pair<const char*, const char*> kFileKeys[] = {
    {"plant", "model"}, {"robot", "goal_file"}, {"start", "model"}, {"start", "bags"}};

/// Makes a relative path, or each relative path of a list, absolute from `folder`; package:// URLs
/// stay unchanged.
void resolvePaths(const std::filesystem::path& folder, YAML::Node value) {
  if (value.IsSequence()) {
    for (const YAML::Node& one : value) resolvePaths(folder, one);
  } else if (value.IsScalar() && !value.Scalar().empty() &&
             value.Scalar().find("://") == std::string::npos) {
    value = (folder / value.Scalar()).lexically_normal().string();
  }
}

}  // namespace

YAML::Node readBlocks(const std::string& path) {
  const std::string text = readFile(path);
  if (text.size() > kMaxBytes) {
    throw std::runtime_error(path + " has more than " + std::to_string(kMaxBytes) +
                             " bytes: it is not a configuration file");
  }
  const YAML::Node blocks = parseBlocks(text, path);
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  for (const auto& [block, key] : kFileKeys) {
    if (hasKey(blocks, block, key)) resolvePaths(folder, blocks[block][key]);
  }
  if (hasKey(blocks, "experiment", "plant")) {
    const YAML::Node plant = blocks["experiment"]["plant"];
    const bool is_file =
        plant.IsScalar() && std::filesystem::path(plant.Scalar()).extension() == ".yaml";
    if (is_file) resolvePaths(folder, plant);
  }
  return blocks;
}

YAML::Node parseBlocks(const std::string& text, const std::string& source) {
  const YAML::Node document = parseYaml(text, source);
  // a preset may contain only comments
  if (document.IsNull()) return YAML::Node(YAML::NodeType::Map);
  if (!document.IsMap()) {
    refuseAt(source, document.Mark(), "expected a map of blocks, got " + oneLine(document));
  }
  requireUniqueKeys(document, source);
  for (const auto& block : document) {
    if (block.second.IsMap()) requireUniqueKeys(block.second, source);
  }
  return document;
}

void overlay(const YAML::Node& above, YAML::Node* below) {
  for (const auto& block : above) {
    const std::string name = block.first.Scalar();
    YAML::Node target = (*below)[name];
    if (target.IsDefined() && target.IsMap() && block.second.IsMap()) {
      for (const auto& entry : block.second) {
        target[entry.first.Scalar()] = YAML::Clone(entry.second);
      }
    } else if (!target.IsDefined() || !block.second.IsNull()) {
      // a copy, because an alias would change together with its anchor
      (*below)[name] = YAML::Clone(block.second);
    }
  }
}

void setValue(const std::string& text, YAML::Node* blocks) {
  const std::size_t equals = text.find('=');
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos || equals == std::string::npos || slash == 0 ||
      slash + 1 >= equals) {
    throw std::invalid_argument("--set must be BLOCK/KEY=VALUE, got '" + text + "'");
  }
  const std::string key = text.substr(slash + 1, equals - slash - 1);
  const std::string value = expandHome(text.substr(equals + 1));
  if (value.empty()) return;
  const bool list = value.front() == '[' && value.back() == ']';
  (*blocks)[text.substr(0, slash)][key] =
      list ? parseYaml(value, "--set " + text) : YAML::Node(value);
}

bool hasKey(const YAML::Node& blocks, const std::string& block, const std::string& key) {
  const YAML::Node values = blocks[block];
  return values.IsDefined() && values.IsMap() && values[key].IsDefined();
}

std::string takeOverLimits(const std::string& learner, YAML::Node* blocks) {
  const bool given = hasKey(*blocks, learner, "max_torque");
  const std::string owner = given ? learner : (*blocks)["robot"].IsDefined() ? "robot" : "plant";
  if (!given && owner == "plant" && hasKey(*blocks, "plant", "model") &&
      !hasKey(*blocks, "plant", "max_torque")) {
    throw std::invalid_argument("plant/max_torque must be given here, since the model file " +
                                (*blocks)["plant"]["model"].as<std::string>() +
                                " is not read: `simulate --describe` prints it");
  }
  if (!hasKey(*blocks, owner, "max_torque")) return "the default";
  const YAML::Node limits = (*blocks)[owner]["max_torque"];
  if (!given && limits.IsSequence() && limits.size() == 0) return "the default";
  const YAML::Node block = (*blocks)[learner];
  if (!given && (!block.IsDefined() || block.IsMap())) {
    (*blocks)[learner]["max_torque"] = YAML::Clone(limits);
  }
  return owner + "/max_torque";
}

}  // namespace ddm
