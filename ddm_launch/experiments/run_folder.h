// The folder of one experiment: everything that it leaves behind, and what resuming needs.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "configuration.h"
#include "evaluation.h"
#include "world.h"

namespace ddm {

/// One row of trials.csv: the model trained on `frames` frames and its greedy evaluation.
struct TrialRow {
  int seed = 0;
  int trial = 0;
  std::uint32_t frames = 0;
  Evaluation evaluation;
  double v_r = 0.0;
  double v_p = 0.0;
  double train_s = 0.0;
  std::uint32_t train_evaluations = 0;
  double plan_ms_median = 0.0;
  double plan_ms_p99 = 0.0;
};

///   config.yaml                          effective configuration and version of the code
///   trials.csv                           one row per finished trial
///   trial_NNN/{trial.bag,torques.csv,model.ddm}
///   evaluation_NNN/{torques.csv,trajectory.csv}
///   summary.yaml                         written last: the verdict
///
/// All files appear under their names only when they are complete.
class RunFolder {
 public:
  /// Makes the folder, or opens that of the same experiment; at most one process holds it.
  /// @throws std::runtime_error if it cannot be written, is held by another process, or holds
  ///         another experiment (the keys that differ are named) or files that make no sense
  explicit RunFolder(const Configuration& configuration);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Things a user should know about a folder that is used again.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Rows of the trials finished so far.
  const std::vector<TrialRow>& rows() const { return rows_; }

  std::string bagPath(int trial) const;
  void writeTrial(int trial, const TrialOutcome& outcome);
  void writeModel(int trial, const std::string& model);
  void writeEvaluation(int trial, const TrialOutcome& outcome);
  /// Ends a trial: from here on it is never run again.
  void finishTrial(const TrialRow& row);
  void writeSummary(double wall_s);

 private:
  std::string makeSubfolder(const std::string& name, int trial) const;
  void lock();
  void compareWith(const std::string& file, const YAML::Node& configuration);
  void readRows(const std::string& file);

  Configuration configuration_;
  std::string path_;
  int lock_file_ = -1;
  std::vector<std::string> warnings_;
  std::vector<TrialRow> rows_;
};

}  // namespace ddm
