// Which frames of a camera are acted on: it has a rate of its own, the loop has its time step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>

#include "ddm_robot/clocks.h"

namespace ddm {

/// Of all frames the one that comes nearest to dt after the last one picked.
///
/// A frame is judged when it comes, so the one picked is the newest there is and not a moment old.
/// With dt a whole multiple of the camera's period T all steps are equally long, whatever the
/// jitter of stamps below T / 2; otherwise they are round(dt / T) T, still equally long.
class FramePicker {
 public:
  /// @param dt  time step, > 0 [s]
  explicit FramePicker(double dt) : dt_(dt) {}

  /// To be called for each frame.
  /// @return whether to act on it; never for one that is not newer than all since restart()
  bool pick(Stamp stamp) {
    const bool first = !last_frame_;
    if (!first) {
      if (stamp <= *last_frame_) return false;
      intervals_.push_back(toSeconds(stamp - *last_frame_));
      if (intervals_.size() > kNumIntervals) intervals_.pop_front();
      period_ = median(intervals_);
    }
    last_frame_ = stamp;
    if (!first && toSeconds(stamp - last_pick_) < dt_ - 0.5 * period_) return false;
    last_pick_ = stamp;
    return true;
  }

  /// The next frame will be picked, whatever its stamp.
  void restart() { last_frame_.reset(); }

  /// Time between frames that are picked, as far as it is known [s]; 0: not yet.
  double step() const {
    return period_ == 0.0 ? 0.0 : std::max(1.0, std::round(dt_ / period_)) * period_;
  }

 private:
  static constexpr std::size_t kNumIntervals = 9;

  /// The lower of two middle ones.
  static double median(std::deque<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  double dt_;
  std::optional<Stamp> last_frame_;  // empty: none since restart()
  Stamp last_pick_{0};
  std::deque<double> intervals_;  // between the latest frames [s]
  double period_ = 0.0;           // T, their median: a lost frame or a pause must not count [s]
};

}  // namespace ddm
