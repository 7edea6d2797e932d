// The folder of one experiment: everything that it leaves behind, and what resuming needs.
// SPDX-License-Identifier: BSD-3-Clause
#include "run_folder.h"

#include <ddm_model/model_file.h>
#include <ddm_msgs/param_value.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <boost/filesystem.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "code_version.h"
#include "trials_csv.h"

namespace ddm {
namespace {

namespace fs = boost::filesystem;

std::string exact(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

std::string torquesCsv(const TrialOutcome& outcome) {
  std::string text = "step,torque_nm,exploratory\n";
  for (size_t step = 0; step < outcome.torques.size(); ++step) {
    text += std::to_string(step) + ",";
    for (Eigen::Index i = 0; i < outcome.torques[step].size(); ++i) {
      text += (i > 0 ? " " : "") + exact(outcome.torques[step][i]);
    }
    text += outcome.exploratory[step] ? ",1\n" : ",0\n";
  }
  return text;
}

std::string trajectoryCsv(const TrialOutcome& outcome) {
  std::string text = "step,time_s,angle_rad,rate_rad_per_s\n";
  for (size_t step = 0; step < outcome.states.size(); ++step) {
    char time[32];
    std::snprintf(time, sizeof(time), "%.9g", outcome.times[step]);
    text += std::to_string(step) + "," + time;
    for (Eigen::Index i = 0; i < outcome.states[step].size(); ++i) {
      text += "," + exact(outcome.states[step][i]);
    }
    text += "\n";
  }
  return text;
}

/// Keys of a configuration and their values, as "block/key".
std::vector<std::pair<std::string, std::string>> flat(const YAML::Node& configuration) {
  std::vector<std::pair<std::string, std::string>> out;
  for (const auto& block : configuration) {
    if (!block.second.IsMap()) continue;
    for (const auto& entry : block.second) {
      out.emplace_back(block.first.as<std::string>() + "/" + entry.first.as<std::string>(),
                       YAML::Dump(entry.second));
    }
  }
  return out;
}

/// Keys in which two runs of one experiment may differ.
bool mayDiffer(const std::string& key) {
  return key == "experiment/trials" || key == "experiment/runs" || key == "experiment/timeout" ||
         key == "sim/watchdog";
}

}  // namespace

RunFolder::RunFolder(const Configuration& configuration)
    : configuration_(configuration), path_(configuration.experiment.runs) {
  if (path_.empty()) throw std::runtime_error("no folder was given for the results");
  boost::system::error_code error;
  fs::create_directories(path_, error);
  if (!fs::is_directory(path_)) {
    throw std::runtime_error("cannot make the folder " + path_ + ": " + error.message());
  }
  lock();
  try {
    const std::string file = path_ + "/config.yaml";
    YAML::Node node = toYaml(configuration_);
    if (fs::exists(file)) {
      compareWith(file, node);
    } else if (fs::exists(path_ + "/trials.csv")) {
      throw std::runtime_error(path_ +
                               " holds a trials.csv but no config.yaml: use another folder");
    }
    readRows(path_ + "/trials.csv");
    YAML::Node versioned(YAML::NodeType::Map);
    versioned["version"] = codeVersion();
    for (const auto& block : node) versioned[block.first] = block.second;
    writeFileAtomically(file, YAML::Dump(versioned) + "\n");
    // No verdict before the end. Not sooner: a command that is refused must leave all as it is.
    fs::remove(path_ + "/summary.yaml", error);
  } catch (...) {
    ::close(lock_file_);
    throw;
  }
}

RunFolder::~RunFolder() { ::close(lock_file_); }

/// The kernel lets go of the lock when the process ends, however it ends.
void RunFolder::lock() {
  const std::string file = path_ + "/.lock";
  lock_file_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock_file_ < 0) {
    throw std::runtime_error("cannot write into the folder " + path_ + ": " + std::strerror(errno));
  }
  if (::flock(lock_file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_file_);
    throw std::runtime_error("another experiment is running in the folder " + path_ +
                             ": wait for it, or use another folder");
  }
}

void RunFolder::compareWith(const std::string& file, const YAML::Node& configuration) {
  YAML::Node there;
  try {
    there = YAML::LoadFile(file);
  } catch (const std::exception& e) {
    throw std::runtime_error(file + " cannot be read (" + e.what() + "): use another folder");
  }
  const auto known = flat(there);
  std::string differences;
  for (const auto& entry : flat(configuration)) {
    if (mayDiffer(entry.first)) continue;
    const auto same_key = std::find_if(known.begin(), known.end(), [&entry](const auto& other) {
      return other.first == entry.first;
    });
    const std::string value = same_key == known.end() ? "nothing" : same_key->second;
    if (value != entry.second) {
      differences += "\n - " + entry.first + ": " + value + " there, " + entry.second + " here";
    }
  }
  if (!differences.empty()) {
    throw std::runtime_error("the folder " + path_ +
                             " holds another experiment, use another folder:" + differences);
  }
  const std::string version =
      there["version"] && there["version"].IsScalar() ? there["version"].as<std::string>() : "?";
  if (version != codeVersion()) {
    warnings_.push_back("the folder " + path_ + " was begun by version " + version +
                        " of the code, this is " + codeVersion() +
                        ": its trials may not be comparable");
  }
}

void RunFolder::readRows(const std::string& file) {
  if (!fs::exists(file)) return;
  rows_ = parseTrialsCsv(readFile(file), file);
  for (size_t i = 0; i < rows_.size(); ++i) {
    if (rows_[i].trial != static_cast<int>(i) || rows_[i].seed != configuration_.experiment.seed) {
      throw std::runtime_error(
          file + ": row " + std::to_string(i + 1) + " must be trial " + std::to_string(i) +
          " of seed " + std::to_string(configuration_.experiment.seed) + ": use another folder");
    }
    if (!fs::exists(bagPath(static_cast<int>(i)))) {
      throw std::runtime_error(
          bagPath(static_cast<int>(i)) +
          " is missing, though trials.csv says that the trial is finished: put "
          "it back, or use another folder");
    }
  }
}

std::string RunFolder::makeSubfolder(const std::string& name, int trial) const {
  char number[16];
  std::snprintf(number, sizeof(number), "_%03d", trial);
  const std::string folder = path_ + "/" + name + number;
  boost::system::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error("cannot make the folder " + folder + ": " + error.message());
  return folder;
}

std::string RunFolder::bagPath(int trial) const {
  return makeSubfolder("trial", trial) + "/trial.bag";
}

void RunFolder::writeTrial(int trial, const TrialOutcome& outcome) {
  writeFileAtomically(makeSubfolder("trial", trial) + "/torques.csv", torquesCsv(outcome));
}

void RunFolder::writeModel(int trial, const std::string& model) {
  writeFileAtomically(makeSubfolder("trial", trial) + "/model.ddm", model);
}

void RunFolder::writeEvaluation(int trial, const TrialOutcome& outcome) {
  const std::string folder = makeSubfolder("evaluation", trial);
  writeFileAtomically(folder + "/torques.csv", torquesCsv(outcome));
  if (!outcome.states.empty()) {
    writeFileAtomically(folder + "/trajectory.csv", trajectoryCsv(outcome));
  }
}

void RunFolder::finishTrial(const TrialRow& row) {
  rows_.push_back(row);
  writeFileAtomically(path_ + "/trials.csv", formatTrialsCsv(rows_));
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
  writeFileAtomically(path_ + "/summary.yaml", YAML::Dump(summary) + "\n");
}

}  // namespace ddm
