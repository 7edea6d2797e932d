// Progress of an experiment on the terminal.
// SPDX-License-Identifier: BSD-3-Clause
#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <boost/format.hpp>
#include <iostream>
#include <utility>

namespace ddm {
namespace {

using boost::format;

constexpr int kBarWidth = 24;
constexpr std::chrono::milliseconds kRedrawPeriod(50);

int countSuccesses(const std::vector<TrialRow>& rows) {
  return static_cast<int>(std::count_if(
      rows.begin(), rows.end(), [](const TrialRow& row) { return row.evaluation.success; }));
}

std::string verdictOf(const Evaluation& evaluation, const std::string& unit) {
  if (!evaluation.known) return "no ground truth";
  if (!evaluation.final_error) return evaluation.success ? "success" : "no success";
  return str(format("error %5.3g %s%s") % *evaluation.final_error % unit %
             (evaluation.success ? "  success" : ""));
}

}  // namespace

Progress::Progress(int num_trials, std::string error_unit)
    : Progress(&std::cout, ::isatty(STDOUT_FILENO) != 0, num_trials, std::move(error_unit)) {}

Progress::Progress(std::ostream* out, bool live, int num_trials, std::string error_unit)
    : out_(out), live_(live), num_trials_(num_trials), error_unit_(std::move(error_unit)) {}

void Progress::note(const std::string& text) {
  wipe();
  *out_ << text << std::endl;
}

void Progress::beginPhase(int trial, const std::string& phase) {
  trial_ = trial;
  phase_ = phase;
  draw(0.0);
}

void Progress::update(double fraction) {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_drawn_ >= kRedrawPeriod) draw(fraction);
}

void Progress::draw(double fraction) {
  if (!live_) return;
  last_drawn_ = std::chrono::steady_clock::now();
  const int filled = static_cast<int>(kBarWidth * std::min(1.0, std::max(0.0, fraction)));
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  *out_ << format("\r\033[Ktrial %2d/%d  %-10s [%s] %3.0f %%  %s") % trial_ % num_trials_ % phase_ %
               bar % (100.0 * fraction) % success_so_far_
        << std::flush;
}

void Progress::wipe() {
  if (live_) *out_ << "\r\033[K";
}

void Progress::finishTrial(const std::vector<TrialRow>& rows) {
  wipe();
  const TrialRow& row = rows.back();
  if (row.evaluation.known) {
    success_so_far_ = str(format("success %d of %d") % countSuccesses(rows) % rows.size());
  }
  // At most 80 columns: a terminal wraps a longer line, and then wipe() cannot erase it.
  const format training = row.v_r && row.v_p ? format("V_R %8.3g  V_P %8.3g") % *row.v_r % *row.v_p
                                             : format("trained in %6.1f s") % row.train_s;
  *out_ << format("trial %2d/%d  %5u frames  %s  %s") % row.trial % num_trials_ % row.frames %
               training % verdictOf(row.evaluation, error_unit_)
        << std::endl;
}

void Progress::summary(const std::vector<TrialRow>& rows, const std::string& folder,
                       double wall_s) {
  wipe();
  double train_s = 0.0;
  const TrialRow* first = nullptr;
  for (const TrialRow& row : rows) {
    train_s += row.train_s;
    if (first == nullptr && row.evaluation.success) first = &row;
  }
  *out_ << "\n"
        << rows.size() << " models trained, the last on " << rows.back().frames << " frames\n";
  if (rows.back().evaluation.known) {
    *out_ << countSuccesses(rows) << " of " << rows.size() << " reached the goal and stayed";
    if (first != nullptr) *out_ << ", the first one after " << first->frames << " frames";
    *out_ << "\n";
  }
  *out_ << format("%.1f s of training in all; this call took %.1f s\n") % train_s % wall_s
        << "results: " << folder << "/trials.csv" << std::endl;
}

}  // namespace ddm
