// Checks the stamps of a sensor, and selects the camera images for the control loop.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/stamp_check.h"

#include <ddm_common/option_checks.h>

#include <algorithm>
#include <cmath>

namespace ddm {
namespace {

// Some seconds of images, in which the drift of clocks is negligible.
constexpr std::size_t kNumOffsets = 100;
constexpr int kLargestDrift = 500;        // clocks drift apart by less than 1 part in kLargestDrift
constexpr std::size_t kNumIntervals = 9;  // number of intervals between images for the median

/// Returns the value at position `index` of the sorted values.
Stamp ranked(std::deque<Stamp> values, std::size_t index) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(index);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Appends a value, and removes the oldest value if there are more than `max_count`.
void append(Stamp value, std::size_t max_count, std::deque<Stamp>* values) {
  values->push_back(value);
  if (values->size() > max_count) values->pop_front();
}

}  // namespace

std::string StampCheck::compare(Stamp clock, Stamp stamp) const {
  const Stamp age = clock - stamp;
  if (age <= dt_ && age >= -dt_) return "";
  if (stamp == Stamp(0)) {
    return item_ +
           " has no stamp, so its age is unknown: let the driver set header.stamp; if the driver "
           "started while /use_sim_time was true, start it again";
  }
  return textOf("the ", sensor_, "'s stamps and this machine's clock differ by ",
                std::abs(toSeconds(age)), " s when ", item_, " arrives, at most ", toSeconds(dt_),
                " s are allowed: let the driver set the stamps, synchronise the clocks");
}

std::string StampCheck::refusal(SteadyTime arrival, Stamp clock, Stamp stamp) const {
  if (!last_) return compare(clock, stamp);
  const Stamp ahead = stamp - arrival.time_since_epoch() - highest_;
  if (ahead <= dt_ && stamp > *last_) return "";
  const std::string problem =
      ahead > dt_
          ? textOf("the ", sensor_, "'s clock has jumped forward by ", toSeconds(ahead), " s")
          : textOf(item_, " is stamped ", toSeconds(*last_ - stamp),
                   " s before the one that came before it: the ", sensor_,
                   "'s clock was set back, or messages come twice or out of order");
  return problem + ". Messages are refused until that clock is right, or until the next reset";
}

std::string StampCheck::take(SteadyTime arrival, Stamp clock, Stamp stamp) {
  std::string problem = refusal(arrival, clock, stamp);
  if (!problem.empty()) {
    ++num_refused_;
    return problem;
  }
  const Stamp offset = stamp - arrival.time_since_epoch();
  highest_ = last_ ? std::max(highest_, offset) : offset;
  last_ = stamp;
  append(offset, kNumOffsets, &offsets_);
  const Stamp usual = ranked(offsets_, offsets_.size() / 2);
  usual_ = usual_ ? std::max(usual, *usual_ - (arrival - arrival_) / kLargestDrift) : usual;
  arrival_ = arrival;
  taken_ = arrival + std::min(Stamp(0), offset - *usual_);
  return "";
}

void StampCheck::restart() {
  last_.reset();
  offsets_.clear();
  usual_.reset();
}

bool ImagePicker::pick(Stamp stamp) {
  const bool first = !last_image_;
  if (!first) {
    if (stamp <= *last_image_) return false;
    append(stamp - *last_image_, kNumIntervals, &intervals_);
    period_ = toSeconds(ranked(intervals_, (intervals_.size() - 1) / 2));
  }
  last_image_ = stamp;
  if (!first && toSeconds(stamp - last_pick_) < dt_ - 0.5 * period_) return false;
  last_pick_ = stamp;
  return true;
}

double ImagePicker::step() const {
  return period_ == 0.0 ? 0.0 : std::max(1.0, std::round(dt_ / period_)) * period_;
}

}  // namespace ddm
