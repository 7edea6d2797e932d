// The folder of one experiment, which holds its results and everything needed to resume it.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_folder.h"

#include <ddm_common/config_blocks.h>
#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/yaml_text.h>
#include <ddm_model/model_file.h>
#include <ddm_plant_plugin/plant_config.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <boost/algorithm/string.hpp>
#include <boost/filesystem.hpp>
#include <boost/format.hpp>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "tables.h"
#include "version.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;
using Keys = std::set<std::string>;

constexpr char kRows[] = "trials.csv";
constexpr char kChecksums[] = ".trials.crc32";
constexpr char kTraining[] = "training.yaml";
constexpr char kSummary[] = "summary.yaml";
constexpr char kConfiguration[] = "config.yaml";

/// Keys that may differ between two calls on the same experiment.
const Keys kMayDiffer = {"experiment/trials", "experiment/runs", "experiment/timeout",
                         "sim/watchdog", "evaluation/record"};

/// Keys that a user tunes on the robot over several launches. They may change until the first trial
/// is finished.
const Keys kChosenOnTheRobot = {"robot/crop", "robot/goal_file", "evaluation/goal_distance"};

/// Lists the differences because of which an experiment cannot be resumed, one per line; empty if
/// there are none. Top-level entries that are not blocks are ignored.
/// @param there  blocks in the folder, by name
/// @param here   blocks of this call, by name
std::string differencesOf(const YAML::Node& there, const YAML::Node& here, bool trial_finished) {
  std::map<std::string, std::pair<std::string, std::string>> values;  // YAML texts by "block/key"
  const auto take = [&values](const YAML::Node& blocks, auto side) {
    for (const auto& block : blocks) {
      if (!block.second.IsMap()) continue;
      for (const auto& entry : block.second) {
        values[block.first.Scalar() + "/" + entry.first.Scalar()].*side = YAML::Dump(entry.second);
      }
    }
  };
  using Pair = std::pair<std::string, std::string>;
  take(there, &Pair::first);
  take(here, &Pair::second);
  const bool robot = there["robot"].IsDefined() && here["robot"].IsDefined();
  const auto words = [](const std::string& value) { return value.empty() ? "nothing" : value; };
  std::string differences;
  for (const auto& [key, value] : values) {
    if (kMayDiffer.count(key) > 0 || value.first == value.second) continue;
    // The file of a plant may have moved. The contents of both files are compared as block `plant`.
    const bool of_files = namesPlantFile(value.first) && namesPlantFile(value.second);
    if (key == "experiment/plant" && of_files) continue;
    const bool chosen = robot && kChosenOnTheRobot.count(key) > 0;
    if (chosen && !trial_finished) continue;
    differences += "\n - " + key + ": " + words(value.first) + " there, " + words(value.second) +
                   " here" +
                   (key == "plant/model_digest"
                        ? ": the model file, or a file that it names, has changed since"
                        : "") +
                   (chosen ? ", fixed since the first trial was finished" : "");
  }
  return differences;
}

/// Renames a file of an earlier attempt: "trial.bag" becomes "trial.1.bag", or "trial.2.bag" if
/// that name is taken.
/// @return the new name; empty if there is no such file
std::string keep(const std::string& stem, const std::string& ending) {
  if (!fs::exists(fs::symlink_status(stem + ending))) return "";
  for (int number = 1;; ++number) {
    const std::string name = stem + "." + std::to_string(number) + ending;
    if (fs::exists(fs::symlink_status(name))) continue;
    fs::rename(stem + ending, name);
    return name;
  }
}

}  // namespace

std::string codeVersion() {
#if defined(__x86_64__) && !defined(__AVX2__)
  return DDM_CODE_VERSION " without AVX2";  // results differ by rounding
#else
  return DDM_CODE_VERSION;
#endif
}

std::string runName(const RunId& run) {
  std::string name =
      boost::str(boost::format("%s_%03d") % (run.evaluation ? "evaluation" : "trial") % run.trial);
  if (run.episode > 0) name += boost::str(boost::format("/episode_%03d") % run.episode);
  return name;
}

RunFolder::RunFolder(const Configuration& configuration)
    : configuration_(configuration),
      path_(configuration.experiment.runs),
      blocks_(toYaml(configuration)) {
  // Name of the graphics driver, for plants whose images depend on the driver.
  const std::string renderer = configuration.robot ? "" : configuration.plant->renderer();
  if (!renderer.empty()) blocks_["renderer"] = renderer;
  if (path_.empty()) throw std::runtime_error("no folder was given for the results");
  if (!fs::exists(path_)) return;
  lock_ = std::make_unique<FolderLock>(path_);
  if (fs::exists(at(kConfiguration))) {
    compareWith(at(kConfiguration));
  } else if (fs::exists(at(kRows))) {
    throw std::runtime_error(path_ + " holds a trials.csv but no config.yaml: use another folder");
  }
  if (fs::exists(at(kRows))) readRows(at(kRows));
}

void RunFolder::compareWith(const std::string& file) {
  YAML::Node there;
  try {
    there = readBlocks(file);
  } catch (const std::exception& e) {
    throw std::runtime_error(file + " cannot be read (" + e.what() + "): use another folder");
  }
  const std::string differences = differencesOf(there, blocks_, fs::exists(at(kRows)));
  if (!differences.empty()) {
    throw std::runtime_error("the folder " + path_ +
                             " holds another experiment, use another folder:" + differences);
  }
  recordings_fit_ = YAML::Dump(there["robot"]) == YAML::Dump(blocks_["robot"]);
  version_ = there["version"].IsDefined() ? there["version"].Scalar() : "?";
  if (version_ != codeVersion()) {
    warnings_.push_back("the folder " + path_ + " was begun by version " + version_ +
                        " of the code, this is " + codeVersion() +
                        ": its results may not be comparable");
  }
}

void RunFolder::readRows(const std::string& file) {
  const std::string text = readFile(file);
  rows_ = parseTrialsCsv(text, file);
  for (size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].trial != static_cast<int>(i) || rows_[i].seed != configuration_.experiment.seed) {
      throw std::runtime_error(
          file + ": row " + std::to_string(i + 1) + " must be trial " + std::to_string(i) +
          " of seed " + std::to_string(configuration_.experiment.seed) + ": use another folder");
    }
    for (int episode = 0; episode < configuration_.trial.episodes; ++episode) {
      const std::string bag = bagPath(static_cast<int>(i), episode);
      if (fs::exists(bag)) continue;
      throw std::runtime_error(bag +
                               " is missing, though trials.csv says that the trial is finished: "
                               "put it back, or use another folder");
    }
  }
  const std::string checksums = at(kChecksums);
  if (!fs::exists(checksums)) {
    warnings_.push_back(file + " has no checksums beside it (.trials.crc32): it is not checked");
    return;
  }
  std::vector<std::string> lines;
  boost::split(lines, readFile(checksums), boost::is_any_of("\n"));
  lines.resize(rows_.size());
  if (rows_.empty() || lines.back() == checksum(text)) return;
  throw std::runtime_error(file + " is not as it was written: it does not match its checksum in " +
                           checksums +
                           ". Put both back, or use another folder; if you have changed the "
                           "table yourself, remove the checksums");
}

std::string RunFolder::bagPath(int trial, int episode) const {
  return at(runName({trial, /*evaluation=*/false, episode}) + "/trial.bag");
}

std::vector<std::string> RunFolder::bagsUpTo(int trial) const {
  std::vector<std::string> bags = configuration_.start.bags;
  for (int k = 0; k <= trial; ++k) {
    for (int episode = 0; episode < configuration_.trial.episodes; ++episode) {
      bags.push_back(bagPath(k, episode));
    }
  }
  return bags;
}

bool RunFolder::isRecorded(const RunId& run) const {
  const std::string folder = at(runName(run));
  if (!recordings_fit_ || !fs::exists(folder + "/trial.bag")) return false;
  // torques.csv is written after the bag. A lock-step trial without it is repeated with the same
  // torques. A trial in real time cannot be repeated exactly, and its bag suffices.
  const bool repeatable = configuration_.sim.lockstep && !configuration_.robot;
  return !repeatable || fs::exists(folder + "/torques.csv");
}

/// Makes the folder, writes config.yaml with the version, and deletes an earlier summary. All
/// functions that write call it. The constructor does not, because a refused command must leave the
/// folder as it is.
void RunFolder::begin() {
  if (begun_) return;
  if (lock_ == nullptr) {
    makeFolder("");
    lock_ = std::make_unique<FolderLock>(path_);
    if (fs::exists(at(kConfiguration))) {
      throw std::runtime_error("another experiment was begun in the folder " + path_ +
                               " meanwhile: use another folder");
    }
  }
  removeUnfinished(path_);
  YAML::Node versioned(YAML::NodeType::Map);
  versioned["version"] = version_;
  for (const auto& block : blocks_) versioned[block.first] = block.second;
  fs::remove(at(kSummary));
  writeFileAtomically(at(kConfiguration), YAML::Dump(versioned) + "\n");
  begun_ = true;
}

void RunFolder::makeFolder(const std::string& name) {
  const std::string folder = at(name);
  boost::system::error_code error;
  fs::create_directories(folder, error);
  if (fs::is_directory(folder)) return;
  throw std::runtime_error("cannot make the folder " + folder + ": " + error.message());
}

std::string RunFolder::beginRun(const RunId& run, std::vector<std::string>* kept) {
  begin();
  makeFolder(runName(run));
  const std::string stem = at(runName(run)) + "/trial";
  for (const char* ending : {".bag", ".bag.active"}) {
    const std::string kept_as = keep(stem, ending);
    if (!kept_as.empty() && kept != nullptr) kept->push_back(kept_as);
  }
  if (!run.evaluation) fs::remove(at(runName({run.trial}) + "/" + kTraining));
  return stem + ".bag";
}

void RunFolder::writeRun(const RunId& run, const TrialOutcome& outcome) {
  const std::string folder = runName(run);
  if (!outcome.states.empty()) {
    write(folder + "/trajectory.csv", formatTrajectoryCsv(outcome.times, outcome.states,
                                                          configuration_.plant_info.state_names));
  } else if (!outcome.goal_distances.empty()) {  // the evaluation is judged by these distances
    std::string text = csvLine("step", "goal_distance");
    for (size_t step = 0; step < outcome.goal_distances.size(); ++step) {
      text += csvLine(step, outcome.goal_distances[step]);
    }
    write(folder + "/goal_distance.csv", text);
  }
  // This file marks the recording as complete, see isRecorded().
  write(folder + "/torques.csv",
        formatTorquesCsv(outcome.torques, outcome.exploratory, torqueNames(configuration_)));
}

void RunFolder::writeTraining(int trial, const TrainingOutcome& outcome) {
  for (const auto& file : outcome.files) write(runName({trial}) + "/" + file.first, file.second);
  YAML::Node training(YAML::NodeType::Map);
  training["frames"] = outcome.frames;
  if (outcome.v_r) training["v_r"] = valueToYaml(*outcome.v_r);
  if (outcome.v_p) training["v_p"] = valueToYaml(*outcome.v_p);
  training["train_s"] = valueToYaml(outcome.seconds);
  training["train_evaluations"] = outcome.evaluations;
  write(runName({trial}) + "/" + kTraining, YAML::Dump(training) + "\n");
}

std::optional<TrainingOutcome> RunFolder::savedTraining(int trial) const {
  const std::string file = at(runName({trial}) + "/" + kTraining);
  if (!fs::exists(file)) return std::nullopt;
  try {
    const YAML::Node training = parseYaml(readFile(file), file);
    TrainingOutcome outcome;
    outcome.frames = training["frames"].as<std::uint32_t>();
    if (training["v_r"].IsDefined()) outcome.v_r = training["v_r"].as<double>();
    if (training["v_p"].IsDefined()) outcome.v_p = training["v_p"].as<double>();
    outcome.seconds = training["train_s"].as<double>();
    outcome.evaluations = training["train_evaluations"].as<std::uint32_t>();
    return outcome;
  } catch (const std::exception&) {  // a damaged file is replaced by another training on the bags
    return std::nullopt;
  }
}

void RunFolder::finishTrial(const TrialRow& row) {
  rows_.push_back(row);
  write(kChecksums, formatTrialsChecksums(rows_));  // before the table, see formatTrialsChecksums()
  write(kRows, formatTrialsCsv(rows_));
}

/// Writes a file, and makes its subfolder if needed.
/// @param name  path relative to this folder
void RunFolder::write(const std::string& name, const std::string& content) {
  begin();
  makeFolder(fs::path(name).parent_path().string());
  writeFileAtomically(at(name), content);
}

void RunFolder::writeSummary(double wall_s) {
  YAML::Node summary(YAML::NodeType::Map);
  summary["finished"] = true;
  summary["preset"] = configuration_.experiment.preset;
  summary["plant"] = configuration_.experiment.plant;
  summary["seed"] = configuration_.experiment.seed;
  summary["trials"] = static_cast<int>(rows_.size()) - 1;
  YAML::Node success(YAML::NodeType::Sequence);
  success.SetStyle(YAML::EmitterStyle::Flow);
  double num_successes = 0.0;
  double train_s = 0.0;
  bool known = true;
  for (const TrialRow& row : rows_) {
    success.push_back(row.evaluation.success ? 1 : 0);
    num_successes += row.evaluation.success ? 1.0 : 0.0;
    train_s += row.train_s;
    known = known && row.evaluation.known;
  }
  if (known) {
    summary["success"] = success;
    summary["mean_success"] = valueToYaml(num_successes / static_cast<double>(rows_.size()));
  }
  summary["train_s"] = valueToYaml(train_s);
  summary["wall_s"] = valueToYaml(wall_s);
  summary["version"] = codeVersion();
  write(kSummary, YAML::Dump(summary) + "\n");
}

bool RunFolder::confirmSummary() const {
  const std::string file = at(kSummary);
  if (!fs::exists(file)) return false;
  try {
    if (!YAML::Load(readFile(file))["finished"].as<bool>(false)) return false;
  } catch (const YAML::Exception&) {
    return false;
  }
  ::utimensat(AT_FDCWD, file.c_str(), nullptr, 0);
  return true;
}

}  // namespace ddm
