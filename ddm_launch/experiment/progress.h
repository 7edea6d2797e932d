// Progress of an experiment on the terminal.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <ostream>
#include <string>
#include <vector>

#include "run_folder.h"

namespace ddm {

/// Prints one lasting line per finished trial. On a terminal, also redraws one line while a phase
/// runs.
class Progress {
 public:
  /// Prints to the standard output.
  explicit Progress(int num_trials = 0, std::string error_unit = "");

  /// @param live        whether `out` is a terminal, on which the progress line is redrawn
  /// @param num_trials  epsilon-greedy trials of the whole experiment
  /// @param error_unit  unit of Plant::goalError()
  Progress(std::ostream* out, bool live, int num_trials, std::string error_unit = "");
  ~Progress() { wipe(); }  // later output, for example an error message, begins on an empty line

  void note(const std::string& text);
  void beginPhase(int trial, const std::string& phase);
  /// @param fraction  of the phase that is done, in [0, 1]
  void update(double fraction);
  /// @param rows  rows of all finished trials; the last row is new
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
