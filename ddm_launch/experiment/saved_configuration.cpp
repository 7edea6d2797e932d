// config.yaml of a folder of results, to compare with what shall run there.
// SPDX-License-Identifier: BSD-3-Clause
#include "saved_configuration.h"

#include <ddm_params/renamed_keys.h>
#include <ddm_params/yaml_text.h>

#include <set>
#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

/// Keys in which two runs of one experiment may differ.
bool mayDiffer(const std::string& key) {
  return key == "experiment/trials" || key == "experiment/runs" || key == "experiment/timeout" ||
         key == "sim/watchdog" || key == "evaluation/record";
}

/// Keys that a user chooses by looking at the robot, which takes more than one launch.
bool isChosenOnTheRobot(const std::string& key) {
  static const std::set<std::string> keys = {"robot/crop_x",     "robot/crop_y",
                                             "robot/crop_width", "robot/crop_height",
                                             "robot/goal_file",  "evaluation/goal_distance"};
  return keys.count(key) > 0;
}

void requireNames(const YAML::Node& map, const std::string& source) {
  for (const auto& entry : map) {
    if (entry.first.IsScalar()) continue;
    throw std::invalid_argument(source + ":" + std::to_string(entry.first.Mark().line + 1) +
                                ": a key must be a plain name");
  }
}

}  // namespace

ConfigurationValues keysOf(const YAML::Node& configuration) {
  ConfigurationValues out;
  for (const auto& block : configuration) {
    if (!block.second.IsMap()) continue;
    for (const auto& entry : block.second) {
      out[block.first.Scalar() + "/" + entry.first.Scalar()] = YAML::Dump(entry.second);
    }
  }
  return out;
}

SavedConfiguration readConfigurationText(const std::string& text, const std::string& source) {
  const YAML::Node as_saved = parseYaml(text, source);
  if (!as_saved.IsMap()) throw std::invalid_argument(source + ":1: expected a map of blocks");
  requireNames(as_saved, source);
  for (const auto& block : as_saved) {
    if (block.second.IsMap()) requireNames(block.second, source);
  }
  const YAML::Node root = withTodaysKeys(as_saved);
  SavedConfiguration saved;
  saved.values = keysOf(root);
  const YAML::Node version = root["version"];
  if (version.IsDefined() && version.IsScalar()) saved.version = version.Scalar();
  return saved;
}

std::string differencesOf(const ConfigurationValues& there, const ConfigurationValues& here,
                          bool trial_finished) {
  const bool robot = there.count("robot/dt") + here.count("robot/dt") == 2;
  std::map<std::string, std::pair<std::string, std::string>> values;
  for (const auto& entry : there) values[entry.first].first = entry.second;
  for (const auto& entry : here) values[entry.first].second = entry.second;
  const auto words = [](const std::string& value) { return value.empty() ? "nothing" : value; };
  std::string differences;
  for (const auto& entry : values) {
    if (mayDiffer(entry.first) || entry.second.first == entry.second.second) continue;
    const bool chosen = robot && isChosenOnTheRobot(entry.first);
    if (chosen && !trial_finished) continue;
    differences += "\n - " + entry.first + ": " + words(entry.second.first) + " there, " +
                   words(entry.second.second) + " here" +
                   (chosen ? ", fixed since the first trial was finished" : "");
  }
  return differences;
}

}  // namespace ddm
