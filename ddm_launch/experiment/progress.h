// Progress of an experiment on the terminal.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <ostream>
#include <string>
#include <vector>

#include "run_folder.h"

namespace ddm {

/// One line that is drawn over itself while a phase runs (terminals only), and one lasting line per
/// finished trial.
class Progress {
 public:
  /// On the standard output.
  explicit Progress(int num_trials = 0, std::string error_unit = "");

  /// @param live        out is a terminal: draw the moving line
  /// @param num_trials  epsilon-greedy trials of the whole experiment
  /// @param error_unit  of the plant's error
  Progress(std::ostream* out, bool live, int num_trials, std::string error_unit = "");
  ~Progress() { wipe(); }  // what comes next, an error perhaps, begins a line of its own

  void note(const std::string& text);
  void beginPhase(int trial, const std::string& phase);
  /// @param fraction  of the phase that is done, in [0, 1]
  void update(double fraction);
  /// @param rows  of all trials so far, the last one just finished
  void finishTrial(const std::vector<TrialRow>& rows);
  void summary(const std::vector<TrialRow>& rows, const std::string& folder, double wall_s);

 private:
  void draw(double fraction);
  void wipe();

  std::ostream* out_;
  bool live_;
  int num_trials_;
  std::string error_unit_;
  int trial_ = 0;
  std::string phase_;
  std::string success_so_far_;
  std::chrono::steady_clock::time_point last_drawn_;
};

}  // namespace ddm
