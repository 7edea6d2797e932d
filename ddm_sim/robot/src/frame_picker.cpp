// Which frames of a camera are acted on: it has a rate of its own, the loop has its time step.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/frame_picker.h"

#include <algorithm>
#include <cmath>

namespace ddm {
namespace {

constexpr std::size_t kNumIntervals = 9;

/// The lower of two middle ones.
double median(std::deque<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

bool FramePicker::pick(Stamp stamp) {
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

void FramePicker::restart() { last_frame_.reset(); }

double FramePicker::step() const {
  return period_ == 0.0 ? 0.0 : std::max(1.0, std::round(dt_ / period_)) * period_;
}

}  // namespace ddm
