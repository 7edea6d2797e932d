// Which frames of a camera are acted on: it has a rate of its own, the loop has its time step.
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_picker.h"

#include <algorithm>
#include <cmath>

namespace ddm {
namespace {

constexpr std::size_t kNumIntervals = 9;

double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

/// The lower of two middle ones.
double median(std::deque<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

bool FramePicker::pick(Time stamp) {
  if (stamp <= last_frame_) return false;
  if (last_frame_.count() > 0) {
    intervals_.push_back(seconds(stamp - last_frame_));
    if (intervals_.size() > kNumIntervals) intervals_.pop_front();
    period_ = median(intervals_);
  }
  last_frame_ = stamp;
  if (started_ && seconds(stamp - last_pick_) < dt_ - 0.5 * period_) return false;
  started_ = true;
  last_pick_ = stamp;
  return true;
}

double FramePicker::step() const {
  return period_ == 0.0 ? 0.0 : std::max(1.0, std::round(dt_ / period_)) * period_;
}

}  // namespace ddm
