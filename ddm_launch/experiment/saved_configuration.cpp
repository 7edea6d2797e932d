// config.yaml of a folder of results, compared with what is to run there.
// SPDX-License-Identifier: BSD-3-Clause
#include "saved_configuration.h"

#include <map>
#include <set>
#include <utility>

namespace ddm {
namespace {

using Keys = std::set<std::string>;

/// In these two runs of one experiment may differ.
const Keys kMayDiffer = {"experiment/trials", "experiment/runs", "experiment/timeout",
                         "sim/watchdog", "evaluation/record"};

/// These a user chooses by looking at the robot, which takes more than one launch.
const Keys kChosenOnTheRobot = {"robot/crop_x",      "robot/crop_y",    "robot/crop_width",
                                "robot/crop_height", "robot/goal_file", "evaluation/goal_distance"};

/// Values as YAML, by "block/key".
std::map<std::string, std::string> valuesOf(const YAML::Node& blocks) {
  std::map<std::string, std::string> out;
  for (const auto& block : blocks) {
    if (!block.second.IsMap()) continue;
    for (const auto& entry : block.second) {
      out[block.first.Scalar() + "/" + entry.first.Scalar()] = YAML::Dump(entry.second);
    }
  }
  return out;
}

}  // namespace

std::string differencesOf(const YAML::Node& there, const YAML::Node& here, bool trial_finished) {
  std::map<std::string, std::pair<std::string, std::string>> values;
  for (const auto& entry : valuesOf(there)) values[entry.first].first = entry.second;
  for (const auto& entry : valuesOf(here)) values[entry.first].second = entry.second;
  const bool robot = there["robot"].IsDefined() && here["robot"].IsDefined();
  const auto words = [](const std::string& value) { return value.empty() ? "nothing" : value; };
  std::string differences;
  for (const auto& entry : values) {
    const std::pair<std::string, std::string>& value = entry.second;
    if (kMayDiffer.count(entry.first) > 0 || value.first == value.second) continue;
    const bool chosen = robot && kChosenOnTheRobot.count(entry.first) > 0;
    if (chosen && !trial_finished) continue;
    differences += "\n - " + entry.first + ": " + words(value.first) + " there, " +
                   words(value.second) + " here" +
                   (entry.first == "plant/model_digest"
                        ? ": the model file, or a file that it names, has changed since"
                        : "") +
                   (chosen ? ", fixed since the first trial was finished" : "");
  }
  return differences;
}

}  // namespace ddm
