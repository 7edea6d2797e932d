// Times between events, and the file that tells their median and 99 % quantile.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace ddm {

class IntervalLog {
 public:
  /// @param num_ignored  first intervals that do not count: connections and caches are new
  explicit IntervalLog(int num_ignored) : num_ignored_(num_ignored) {}

  /// An event is now.
  void tick();
  int size() const { return static_cast<int>(intervals_us_.size()); }
  /// `{median_us: ..., p99_us: ..., count: ...}`, which appears at once and whole.
  /// @throws std::runtime_error if there is nothing to tell, or the file cannot be written
  void write(const std::string& path) const;

 private:
  int num_ignored_;
  std::chrono::steady_clock::time_point last_;
  bool first_ = true;
  std::vector<double> intervals_us_;
};

}  // namespace ddm
