// The folder of one experiment, which holds its results and everything needed to resume it.
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

/// Package version, commit, and the instruction set if it is not the default: "1.0.0 (1a2b3c4)".
std::string codeVersion();

/// Identifies one episode.
struct RunId {
  int trial = 0;
  bool evaluation = false;  ///< true for the greedy evaluation after the trial
  int episode = 0;          ///< index within the trial
};

/// Subfolder of an episode: "trial_007", "evaluation_007" for the greedy evaluation,
/// "trial_007/episode_001" for the second episode.
std::string runName(const RunId& run);

/// Reads and writes the folder of one experiment, whose files doc/reference/run_folder.md lists. A
/// folder holds one configuration and is used by one process at a time. A file appears under its
/// name only when it is complete. In a trial, torques.csv is written after the bag and training.yaml
/// after all other files of the training, so that they tell how far an earlier call came.
class RunFolder {
 public:
  /// Reads the folder, which need not exist, and changes nothing. An existing folder is locked with
  /// the file .lock while this object lives.
  /// @throws std::runtime_error if another process uses the folder, if it belongs to another
  ///         experiment (the message names the keys that differ), or if its files are not valid
  explicit RunFolder(const Configuration& configuration);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Warnings for a user who resumes an experiment.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Rows of the trials finished so far.
  const std::vector<TrialRow>& rows() const { return rows_; }

  std::string bagPath(int trial, int episode = 0) const;
  /// All bags to learn from after a trial: those of `start`, then those of all episodes so far.
  std::vector<std::string> bagsUpTo(int trial) const;
  /// Whether this episode has been recorded completely and need not be repeated.
  bool isRecorded(const RunId& run) const;
  /// Folder for the files of a training, such as model.ddm.
  std::string trainingPath(int trial) const { return at(runName({trial})); }

  /// The functions below throw std::runtime_error with path and reason if they cannot write, also if
  /// another process has begun an experiment in this folder meanwhile.

  /// Makes the folder of an episode that will be recorded. Bags of an earlier attempt, complete or
  /// not, are renamed and kept, because they may be the only data of that attempt.
  /// @param kept  (optional) out: the new names are appended
  /// @return      path for the new bag, at which no file exists
  std::string beginRun(const RunId& run, std::vector<std::string>* kept = nullptr);
  void writeRun(const RunId& run, const TrialOutcome& outcome);
  void writeTraining(int trial, const TrainingOutcome& outcome);
  /// The result of a training as in training.yaml, without the content of the model file. Empty if
  /// no training has been finished on the bags that are in the folder now.
  std::optional<TrainingOutcome> savedTraining(int trial) const;
  /// Adds a row to trials.csv. A trial that has a row is never run again.
  void finishTrial(const TrialRow& row);

  void writeSummary(double wall_s);
  /// Whether summary.yaml exists and says `finished: true`. If so, sets only the modification time
  /// of the file to now: a caller can then tell that the experiment was already finished.
  bool confirmSummary() const;

 private:
  std::string at(const std::string& name) const {
    return name.empty() ? path_ : path_ + "/" + name;
  }
  void compareWith(const std::string& file);
  void readRows(const std::string& file);
  void begin();
  void makeFolder(const std::string& name);
  void write(const std::string& name, const std::string& content);

  Configuration configuration_;
  std::string path_;
  YAML::Node blocks_;                       // the configuration and the description of its renderer
  std::string version_ = codeVersion();     // version that began the experiment
  std::unique_ptr<const FolderLock> lock_;  // null if the folder does not exist yet
  bool begun_ = false;
  // False if crop or goal of the robot have changed since config.yaml was written: images recorded
  // before and after the change must not be mixed.
  bool recordings_fit_ = true;
  std::vector<std::string> warnings_;
  std::vector<TrialRow> rows_;
};

}  // namespace ddm
