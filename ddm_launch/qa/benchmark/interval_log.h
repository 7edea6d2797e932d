// Times between events, and the file that tells their median and 99 % quantile.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace ddm {

/// Events may be heard of several at a time, so an interval is the mean over kEvents of them.
class IntervalLog {
 public:
  static constexpr int kEvents = 100;

  /// An event is now. The first kEvents do not count: connections and caches are new.
  void tick();
  int numEvents() const { return num_events_; }
  /// `{median_us: ..., p99_us: ..., count: ...}`, which appears at once and whole.
  /// @throws std::runtime_error if there is nothing to tell, or the file cannot be written
  void write(const std::string& path) const;

 private:
  int num_events_ = 0;
  std::chrono::steady_clock::time_point last_;
  std::vector<double> intervals_us_;
};

}  // namespace ddm
