// A folder of results: one configuration, one process at a time.
// SPDX-License-Identifier: BSD-3-Clause
#include "results_folder.h"

#include <ddm_common/config_blocks.h>
#include <ddm_common/plain_file.h>
#include <ddm_plant_plugin/plant_config.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <boost/filesystem.hpp>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "version.h"

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

namespace fs = boost::filesystem;

void makeFolders(const std::string& path) {
  boost::system::error_code error;
  fs::create_directories(path, error);
  if (!fs::is_directory(path)) {
    throw std::runtime_error("cannot make the folder " + path + ": " + error.message());
  }
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
    // A plant's file may have moved, or its path be relative: what is in it is compared.
    const bool of_files = namesPlantFile(value.first) && namesPlantFile(value.second);
    if (entry.first == "experiment/plant" && of_files) continue;
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

std::string codeVersion() {
#if defined(__x86_64__) && !defined(__AVX2__)
  return DDM_CODE_VERSION " without AVX2";  // it rounds differently
#else
  return DDM_CODE_VERSION;
#endif
}

ResultsFolder::ResultsFolder(std::string path, YAML::Node configuration)
    : path_(std::move(path)), configuration_(std::move(configuration)) {
  if (path_.empty()) throw std::runtime_error("no folder was given for the results");
  if (!fs::exists(path_)) return;
  lock_ = std::make_unique<FolderLock>(path_);
  if (fs::exists(path_ + "/config.yaml")) {
    compareWith(path_ + "/config.yaml");
  } else if (fs::exists(path_ + "/trials.csv")) {
    throw std::runtime_error(path_ + " holds a trials.csv but no config.yaml: use another folder");
  }
}

void ResultsFolder::compareWith(const std::string& file) {
  YAML::Node there;
  try {
    there = readBlocks(file);
  } catch (const std::exception& e) {
    throw std::runtime_error(file + " cannot be read (" + e.what() + "): use another folder");
  }
  const std::string differences =
      differencesOf(there, configuration_, fs::exists(path_ + "/trials.csv"));
  if (!differences.empty()) {
    throw std::runtime_error("the folder " + path_ +
                             " holds another experiment, use another folder:" + differences);
  }
  recordings_fit_ = YAML::Dump(there["robot"]) == YAML::Dump(configuration_["robot"]);
  version_ = there["version"].IsDefined() ? there["version"].Scalar() : "?";
  if (version_ != codeVersion()) {
    warn("the folder " + path_ + " was begun by version " + version_ + " of the code, this is " +
         codeVersion() + ": its results may not be comparable");
  }
}

void ResultsFolder::begin() {
  if (begun_) return;
  if (lock_ == nullptr) {
    makeFolders(path_);
    lock_ = std::make_unique<FolderLock>(path_);
    if (fs::exists(path_ + "/config.yaml")) {
      throw std::runtime_error("another experiment was begun in the folder " + path_ +
                               " meanwhile: use another folder");
    }
  }
  removeUnfinished(path_);
  YAML::Node versioned(YAML::NodeType::Map);
  versioned["version"] = version_;
  for (const auto& block : configuration_) versioned[block.first] = block.second;
  fs::remove(path_ + "/summary.yaml");
  writeFileAtomically(path_ + "/config.yaml", YAML::Dump(versioned) + "\n");
  begun_ = true;
}

void ResultsFolder::makeFolder(const std::string& name) {
  begin();
  makeFolders(path_ + "/" + name);
}

void ResultsFolder::write(const std::string& name, const std::string& content) {
  makeFolder(fs::path(name).parent_path().string());
  writeFileAtomically(path_ + "/" + name, content);
}

bool ResultsFolder::isFinished() const {
  const std::string file = path_ + "/summary.yaml";
  if (!fs::exists(file)) return false;
  try {
    return YAML::Load(readFile(file))["finished"].as<bool>(false);
  } catch (const YAML::Exception&) {
    return false;
  }
}

bool ResultsFolder::confirmSummary() const {
  if (!isFinished()) return false;
  ::utimensat(AT_FDCWD, (path_ + "/summary.yaml").c_str(), nullptr, 0);
  return true;
}

void ResultsFolder::finish(const YAML::Node& summary) {
  YAML::Node all(YAML::NodeType::Map);
  all["finished"] = true;
  for (const auto& entry : summary) all[entry.first] = entry.second;
  all["version"] = codeVersion();
  write("summary.yaml", YAML::Dump(all) + "\n");
}

}  // namespace ddm
