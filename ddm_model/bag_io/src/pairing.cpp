// Which torque acted after which image.
// SPDX-License-Identifier: BSD-3-Clause
#include "pairing.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ddm {
namespace {

constexpr double kGap = 1.5;         // in median intervals
constexpr double kTolerance = 0.25;  // of dt: how far an image may be from where it is due

bool isEarlier(const TimedTorque& a, const TimedTorque& b) { return a.time < b.time; }

/// [s]; 0 if there are fewer than two.
double medianInterval(const std::vector<ros::Time>& times) {
  std::vector<double> intervals;
  for (size_t i = 1; i < times.size(); ++i) {
    intervals.push_back((times[i] - times[i - 1]).toSec());
  }
  if (intervals.empty()) return 0.0;
  // The lower of two middle ones: a gap only ever lengthens an interval.
  const auto middle = intervals.begin() + (intervals.size() - 1) / 2;
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// The image nearest to a time.
/// @param images  at least one
std::set<ros::Time>::const_iterator nearest(const std::set<ros::Time>& images,
                                            const ros::Time& time) {
  auto later = images.lower_bound(time);
  if (later == images.begin()) return later;
  const auto earlier = std::prev(later);
  return later == images.end() || time - *earlier < *later - time ? earlier : later;
}

/// Images dt apart; bool: whether a new segment begins.
std::vector<std::pair<ros::Time, bool>> pickImages(const std::set<ros::Time>& images, double dt) {
  std::vector<std::pair<ros::Time, bool>> picked;
  for (auto image = images.begin(); image != images.end();) {
    const bool due = !picked.empty();
    if (due) {
      const ros::Time time = picked.back().first + ros::Duration(dt);
      const auto candidate = nearest(images, time);
      const double off = (*candidate - time).toSec();
      if (std::abs(off) <= kTolerance * dt) {
        picked.emplace_back(*candidate, false);
        image = std::next(candidate);
        continue;
      }
      image = images.upper_bound(time);  // after the gap
      if (image == images.end()) break;
    }
    picked.emplace_back(*image, true);
    ++image;
  }
  return picked;
}

}  // namespace

double Pairs::interval() const {
  std::vector<ros::Time> times;
  for (const Frame& frame : frames) times.push_back(frame.image);
  return medianInterval(times);
}

Pairs pairByStamp(const std::set<ros::Time>& images, std::vector<TimedTorque> torques) {
  std::stable_sort(torques.begin(), torques.end(), isEarlier);
  Pairs pairs;
  bool new_segment = true;
  auto image = images.begin();
  for (size_t i = 0; i < torques.size(); ++i) {
    if (i > 0 && torques[i].time == torques[i - 1].time) {
      if (torques[i].torque == torques[i - 1].torque) continue;  // recorded twice
      throw std::runtime_error("two different torques have the stamp " +
                               std::to_string(torques[i].time.toSec()) + " s");
    }
    for (; image != images.end() && *image < torques[i].time; ++image) {
      pairs.images_without_torque.push_back(*image);
      new_segment = true;
    }
    if (image == images.end() || *image != torques[i].time) {
      pairs.torques_without_image.push_back(torques[i].time);
      continue;
    }
    pairs.frames.push_back({*image++, torques[i].torque, new_segment});
    new_segment = false;
  }
  pairs.images_without_torque.insert(pairs.images_without_torque.end(), image, images.end());
  const double gap = kGap * pairs.interval();
  for (size_t i = 1; i < pairs.frames.size(); ++i) {
    const double interval = (pairs.frames[i].image - pairs.frames[i - 1].image).toSec();
    pairs.frames[i].new_segment = pairs.frames[i].new_segment || interval > gap;
  }
  return pairs;
}

Pairs pairInTime(const std::set<ros::Time>& images, std::vector<TimedTorque> torques, double dt) {
  const double apart = medianInterval({images.begin(), images.end()});
  if (apart > (1.0 + kTolerance) * dt) {
    std::ostringstream text;
    text << "its images are " << apart << " s apart, and frames must be data_set/dt = " << dt
         << " s apart: make that as long as images are apart, or longer";
    throw std::runtime_error(text.str());
  }
  std::stable_sort(torques.begin(), torques.end(), isEarlier);
  std::vector<ros::Time> times;
  for (const TimedTorque& torque : torques) times.push_back(torque.time);
  const double in_force = std::max(dt, kGap * medianInterval(times));

  const auto picked = pickImages(images, dt);
  Pairs pairs;
  bool broken = true;      // the chain of frames
  size_t next_torque = 0;  // the first that is not counted yet
  for (size_t i = 0; i < picked.size(); ++i) {
    const ros::Time begin = picked[i].first;
    const bool continued = i + 1 < picked.size() && !picked[i + 1].second;
    const ros::Time end = continued ? picked[i + 1].first : begin + ros::Duration(dt);
    const auto after = std::lower_bound(times.begin(), times.end(), end);
    const bool acts = after != times.begin() && (end - *std::prev(after)).toSec() <= in_force;
    broken = broken || picked[i].second;
    if (!acts) {
      pairs.images_without_torque.push_back(begin);
      broken = true;
      continue;
    }
    const auto last = static_cast<size_t>(after - times.begin()) - 1;
    for (; next_torque < times.size() && times[next_torque] < begin; ++next_torque) {
      if (next_torque != last) pairs.torques_without_image.push_back(times[next_torque]);
    }
    next_torque = std::max(next_torque, last + 1);
    pairs.frames.push_back({begin, torques[last].torque, broken});
    broken = false;
  }
  pairs.torques_without_image.insert(pairs.torques_without_image.end(),
                                     times.begin() + static_cast<std::ptrdiff_t>(next_torque),
                                     times.end());
  return pairs;
}

}  // namespace ddm
