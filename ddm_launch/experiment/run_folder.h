// The folder of one experiment: everything that it leaves behind, and what resuming needs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/folder_lock.h>
#include <yaml-cpp/yaml.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "configuration.h"
#include "driver.h"
#include "evaluation.h"

namespace ddm {

/// Version of the package, commit, and instruction set if it is not the usual one: "1.0.0 (1a2b3c4)".
std::string codeVersion();

/// One run of the plant from an initial state.
struct RunId {
  int trial = 0;
  bool evaluation = false;  ///< the greedy run after the trial
  int episode = 0;          ///< of the trial
};

/// Folder of a run within that of its experiment: "trial_007", "evaluation_007" of the greedy run,
/// "trial_007/episode_001" of the second episode.
std::string runName(const RunId& run);

/// One configuration, one process at a time. All files appear under their names only when they are
/// complete.
///
///   config.yaml                          effective configuration, version of the code that began
///   trials.csv                           one row per finished trial
///   .trials.crc32                        its checksums
///   trial_NNN/{trial.bag,torques.csv,trajectory.csv} and the files of the training, model.ddm
///   trial_NNN/training.yaml              written last: the training is done, its part of the row
///   evaluation_NNN/{torques.csv,trajectory.csv}, and trial.bag with evaluation/record
///   evaluation_NNN/goal_distance.csv     instead of the trajectory, where nobody tells it
///   trial_NNN/episode_EEE/               the same of its second, third, ... episode, where it has them
///   trial_NNN/trial.K.bag[.active]       of the K-th try that was not finished
///   summary.yaml                         written last: the verdict
class RunFolder {
 public:
  /// Looks at the folder, which need not exist, and changes nothing. If the folder is there, it is
  /// locked while this object lives, by the file .lock.
  /// @throws std::runtime_error if it is held by another process, or holds another experiment (the
  ///         keys that differ are named) or files that make no sense
  explicit RunFolder(const Configuration& configuration);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Things a user should know about a folder that is used again.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Rows of the trials finished so far.
  const std::vector<TrialRow>& rows() const { return rows_; }

  std::string bagPath(int trial, int episode = 0) const;
  /// All bags to learn from after a trial: those of `start`, then those of each episode so far.
  std::vector<std::string> bagsUpTo(int trial) const;
  /// Whether an earlier call recorded this run completely, so that it is not to be repeated.
  bool isRecorded(const RunId& run) const;
  /// Folder where a training leaves its files.
  std::string trainingPath(int trial) const { return at(runName({trial})); }
  /// Its model, if it can be saved.
  std::string modelPath(int trial) const { return trainingPath(trial) + "/model.ddm"; }

  /// Makes the folder, keeps the configuration with the version that began, and takes back an
  /// earlier summary. Called by all that writes: before the first result, and no sooner, since a
  /// command that is refused must leave everything as it is.
  /// @throws std::runtime_error with path and reason, also if another process has begun meanwhile
  void begin();
  /// Makes the folder of a run of a trial that is to be recorded. Bags of an earlier try, complete
  /// or not, are kept under other names: they may be all that is left of it.
  /// @param kept  (optional) out: their new names are added
  /// @return      path of its bag, where nothing is
  std::string beginRun(const RunId& run, std::vector<std::string>* kept = nullptr);
  void writeRun(const RunId& run, const TrialOutcome& outcome);
  void writeTraining(int trial, const TrainingOutcome& outcome);
  /// The result of a training as training.yaml holds it, without the model's file. Empty if no
  /// training has been finished on the bags that are in the folder now.
  std::optional<TrainingOutcome> savedTraining(int trial) const;
  /// Ends a trial: from here on it is never run again.
  void finishTrial(const TrialRow& row);

  /// @param name  of a file in this folder, may be in a folder within, which is made
  /// @throws std::runtime_error with path and reason
  void write(const std::string& name, const std::string& content);
  void writeSummary(double wall_s);
  /// Writes summary.yaml, which begins with `finished: true` and ends with the version.
  void finish(const YAML::Node& summary);
  /// Whether there is a summary.yaml that says so. If there is, sets its time to now and changes
  /// nothing else, by which its caller can tell that a call found everything finished.
  bool confirmSummary() const;

 private:
  std::string at(const std::string& name) const {
    return name.empty() ? path_ : path_ + "/" + name;
  }
  void compareWith(const std::string& file);
  void readRows(const std::string& file);
  void makeFolder(const std::string& name);

  Configuration configuration_;
  std::string path_;
  YAML::Node blocks_;                       // of the configuration, and what draws its images
  std::string version_ = codeVersion();     // of the code that began
  std::unique_ptr<const FolderLock> lock_;  // null: the folder is not there yet
  bool begun_ = false;
  // False if crop or goal of the robot have been chosen anew since config.yaml was written: images
  // recorded before do not go with those to come.
  bool recordings_fit_ = true;
  std::vector<std::string> warnings_;
  std::vector<TrialRow> rows_;
};

}  // namespace ddm
