// The folder of one experiment: everything that it leaves behind, and what resuming needs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "configuration.h"
#include "driver.h"
#include "evaluation.h"
#include "results_folder.h"

namespace ddm {

/// One row of trials.csv: the model trained on `frames` frames and its greedy evaluation.
struct TrialRow {
  int seed = 0;
  int trial = 0;
  std::uint32_t frames = 0;
  Evaluation evaluation;
  std::optional<double> v_r;  ///< empty: the method has none
  std::optional<double> v_p;
  double train_s = 0.0;
  std::uint32_t train_evaluations = 0;
  double plan_ms_median = 0.0;
  double plan_ms_p99 = 0.0;
  std::string version = "?";  ///< of the code that produced the row; "?": not known
};

/// One run of the plant from a start.
struct RunId {
  int trial = 0;
  bool evaluation = false;  ///< the greedy run after the trial
  int episode = 0;          ///< of the trial
};

/// Folder of a run within that of its experiment: "trial_007", "evaluation_007" of the greedy run,
/// "trial_007/episode_001" of the second episode.
std::string runName(const RunId& run);

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
class RunFolder : public ResultsFolder {
 public:
  /// Looks at the folder, which need not exist, and changes nothing: the first that is written
  /// makes it. If it is there, no other process gets it while this object lives.
  /// @throws std::runtime_error if it is held by another process, or holds another experiment (the
  ///         keys that differ are named) or files that make no sense
  explicit RunFolder(const Configuration& configuration);

  /// Rows of the trials finished so far.
  const std::vector<TrialRow>& rows() const { return rows_; }

  std::string bagPath(int trial, int episode = 0) const;
  /// All bags to learn from after a trial: those of `start`, then those of each episode so far.
  std::vector<std::string> bagsUpTo(int trial) const;
  /// Whether an earlier call recorded this run completely, so that it is not to be repeated.
  bool isRecorded(const RunId& run) const;
  /// Folder where a training leaves its files.
  std::string trainingPath(int trial) const;
  /// Its model, if it can be saved.
  std::string modelPath(int trial) const { return trainingPath(trial) + "/model.ddm"; }
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
  void writeSummary(double wall_s);

 private:
  void readRows(const std::string& file);

  Configuration configuration_;
  std::vector<TrialRow> rows_;
};

}  // namespace ddm
