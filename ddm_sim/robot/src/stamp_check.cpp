// Whether the stamps of a sensor can be trusted: each is compared with the arrival of its message.
// SPDX-License-Identifier: BSD-3-Clause
#include "ddm_robot/stamp_check.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace ddm {
namespace {

constexpr std::size_t kNumOffsets = 100;  // some seconds of a camera: drift within them is nothing
constexpr int kLargestDrift = 500;        // clocks drift apart by less than 1 part in this many

Stamp median(const std::deque<Stamp>& values) {
  std::vector<Stamp> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace

std::string StampCheck::compare(Stamp clock, Stamp stamp) const {
  const Stamp age = clock - stamp;
  if (age <= dt_ && age >= -dt_) return "";
  std::ostringstream text;
  if (stamp == Stamp(0)) {
    text << item_ << " has no stamp, so its age is unknown: let the driver set header.stamp";
    return text.str();
  }
  text << "the " << sensor_ << "'s stamps and this machine's clock differ by "
       << std::abs(toSeconds(age)) << " s when " << item_ << " arrives, at most " << toSeconds(dt_)
       << " s are allowed: let the driver set the stamps, synchronise the clocks";
  return text.str();
}

std::string StampCheck::refusal(SteadyTime arrival, Stamp clock, Stamp stamp) const {
  if (!last_) return compare(clock, stamp);
  const Stamp ahead = stamp - arrival.time_since_epoch() - highest_;
  std::ostringstream text;
  if (ahead > dt_) {
    text << "the " << sensor_ << "'s clock has jumped forward by " << toSeconds(ahead) << " s";
  } else if (stamp <= *last_) {
    text << item_ << " is stamped " << toSeconds(*last_ - stamp)
         << " s before the one that came before it: the " << sensor_
         << "'s clock was set back, or messages come twice or out of order";
  } else {
    return "";
  }
  text << ". Messages are refused until that clock is right, or until the next reset";
  return text.str();
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
  offsets_.push_back(offset);
  if (offsets_.size() > kNumOffsets) offsets_.pop_front();
  const Stamp usual = median(offsets_);
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

}  // namespace ddm
