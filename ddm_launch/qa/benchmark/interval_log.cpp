// Times between events, and the file that tells their median and 99 % quantile.
// SPDX-License-Identifier: BSD-3-Clause
#include "interval_log.h"

#include <ddm_files/plain_file.h>
#include <ddm_params/param_value.h>

#include <stdexcept>

#include "evaluation.h"

namespace ddm {

void IntervalLog::tick() {
  if (++num_events_ % kEvents != 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (num_events_ > kEvents) {
    intervals_us_.push_back(std::chrono::duration<double, std::micro>(now - last_).count() /
                            kEvents);
  }
  last_ = now;
}

void IntervalLog::write(const std::string& path) const {
  if (intervals_us_.empty()) throw std::runtime_error("no round trip was timed");
  writeFileAtomically(path, "{median_us: " + formatDouble(quantile(intervals_us_, 0.5)) +
                                ", p99_us: " + formatDouble(quantile(intervals_us_, 0.99)) +
                                ", count: " + std::to_string(intervals_us_.size()) + "}\n");
}

}  // namespace ddm
