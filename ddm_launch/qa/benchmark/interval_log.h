// Times between events, and the file that tells their median and 99 % quantile.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_files/plain_file.h>
#include <ddm_params/param_value.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

#include "evaluation.h"

namespace ddm {

/// Events may be heard of several at a time, so an interval is the mean over kEvents of them.
class IntervalLog {
 public:
  static constexpr int kEvents = 100;

  /// An event is now. The first kEvents do not count: connections and caches are new.
  void tick() {
    if (++num_events_ % kEvents != 0) return;
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::micro> interval = now - last_;
    if (num_events_ > kEvents) intervals_us_.push_back(interval.count() / kEvents);
    last_ = now;
  }
  int numEvents() const { return num_events_; }

  /// `{median_us: ..., p99_us: ...}`, which appears at once and whole.
  /// @throws std::runtime_error if there is nothing to tell, or the file cannot be written
  void write(const std::string& path) const {
    if (intervals_us_.empty()) throw std::runtime_error("no round trip was timed");
    writeFileAtomically(path, "{median_us: " + formatDouble(quantile(intervals_us_, 0.5)) +
                                  ", p99_us: " + formatDouble(quantile(intervals_us_, 0.99)) +
                                  "}\n");
  }

 private:
  int num_events_ = 0;
  std::chrono::steady_clock::time_point last_;
  std::vector<double> intervals_us_;
};

}  // namespace ddm
