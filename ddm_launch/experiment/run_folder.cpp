// The folder of one experiment: everything that it leaves behind, and what resuming needs.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_folder.h"

#include <ddm_common/param_value.h>
#include <ddm_common/plain_file.h>
#include <ddm_common/yaml_text.h>

#include <boost/filesystem.hpp>
#include <boost/format.hpp>
#include <stdexcept>

#include "csv_text.h"
#include "run_csv.h"
#include "trials_csv.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;

constexpr char kRows[] = "trials.csv";
constexpr char kChecksums[] = ".trials.crc32";
constexpr char kTraining[] = "training.yaml";

/// Gives a file of an earlier try another name: "trial.bag" is "trial.1.bag" then, or
/// "trial.2.bag".
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

std::string runName(const RunId& run) {
  std::string name =
      boost::str(boost::format("%s_%03d") % (run.evaluation ? "evaluation" : "trial") % run.trial);
  if (run.episode > 0) name += boost::str(boost::format("/episode_%03d") % run.episode);
  return name;
}

namespace {

/// The configuration, with the driver that draws the images where their pixels depend on it.
YAML::Node withRenderer(const Configuration& configuration) {
  YAML::Node blocks = toYaml(configuration);
  const std::string renderer = configuration.robot ? "" : configuration.plant->renderer();
  if (!renderer.empty()) blocks["renderer"] = renderer;
  return blocks;
}

}  // namespace

RunFolder::RunFolder(const Configuration& configuration)
    : ResultsFolder(configuration.experiment.runs, withRenderer(configuration)),
      configuration_(configuration) {
  readRows(path() + "/" + kRows);
}

void RunFolder::readRows(const std::string& file) {
  if (!fs::exists(file)) return;
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
  const std::string checksums = path() + "/" + kChecksums;
  if (!fs::exists(checksums)) {
    warn(file + " has no checksums beside it (" + kChecksums + "): it is taken as it is");
  } else if (!isUnchanged(text, rows_.size(), readFile(checksums))) {
    throw std::runtime_error(
        file + " is not as it was written: it does not match its checksum in " + checksums +
        ". Put both back, or use another folder; if you have changed the "
        "table yourself, remove the checksums");
  }
}

std::string RunFolder::bagPath(int trial, int episode) const {
  return path() + "/" + runName({trial, /*evaluation=*/false, episode}) + "/trial.bag";
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
  const std::string folder = path() + "/" + runName(run);
  if (!recordingsFit() || !fs::exists(folder + "/trial.bag")) return false;
  // Written after the bag. Lock-step gives the same torques again; in real time the bag has to do.
  const bool repeatable = configuration_.sim.lockstep && !configuration_.robot;
  return !repeatable || fs::exists(folder + "/torques.csv");
}

std::string RunFolder::trainingPath(int trial) const { return path() + "/" + runName({trial}); }

std::string RunFolder::beginRun(const RunId& run, std::vector<std::string>* kept) {
  const std::string folder = runName(run);
  makeFolder(folder);
  const std::string stem = path() + "/" + folder + "/trial";
  for (const char* ending : {".bag", ".bag.active"}) {
    const std::string kept_as = keep(stem, ending);
    if (!kept_as.empty() && kept != nullptr) kept->push_back(kept_as);
  }
  if (!run.evaluation) fs::remove(trainingPath(run.trial) + "/" + kTraining);
  return stem + ".bag";
}

void RunFolder::writeTraining(int trial, const TrainingOutcome& outcome) {
  for (const auto& file : outcome.files) {
    write(runName({trial}) + "/" + file.first, file.second);
  }
  YAML::Node training(YAML::NodeType::Map);
  training["frames"] = outcome.frames;
  if (outcome.v_r) training["v_r"] = valueToYaml(*outcome.v_r);
  if (outcome.v_p) training["v_p"] = valueToYaml(*outcome.v_p);
  training["train_s"] = valueToYaml(outcome.seconds);
  training["train_evaluations"] = outcome.evaluations;
  write(runName({trial}) + "/" + kTraining, YAML::Dump(training) + "\n");
}

std::optional<TrainingOutcome> RunFolder::savedTraining(int trial) const {
  const std::string file = trainingPath(trial) + "/" + kTraining;
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
  } catch (const std::exception&) {  // damaged: a training on the bags gives it again
    return std::nullopt;
  }
}

void RunFolder::writeRun(const RunId& run, const TrialOutcome& outcome) {
  const std::string folder = runName(run);
  if (!outcome.states.empty()) {
    write(folder + "/trajectory.csv", formatTrajectoryCsv(outcome.times, outcome.states,
                                                          configuration_.plant_info.state_names));
  } else if (!outcome.goal_distances.empty()) {  // what a run without ground truth is judged by
    std::string text = csvLine("step", "goal_distance");
    for (size_t step = 0; step < outcome.goal_distances.size(); ++step) {
      text += csvLine(step, outcome.goal_distances[step]);
    }
    write(folder + "/goal_distance.csv", text);
  }
  // Last: see isRecorded().
  write(folder + "/torques.csv",
        formatTorquesCsv({outcome.torques, outcome.exploratory}, torqueNames(configuration_)));
}

void RunFolder::finishTrial(const TrialRow& row) {
  rows_.push_back(row);
  write(kChecksums, formatTrialsChecksums(rows_));  // first, see formatTrialsChecksums()
  write(kRows, formatTrialsCsv(rows_));
}

void RunFolder::writeSummary(double wall_s) {
  YAML::Node summary(YAML::NodeType::Map);
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
  finish(summary);
}

}  // namespace ddm
