// Which torque acted after which image.
// SPDX-License-Identifier: BSD-3-Clause
#include "pairing.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace ddm {
namespace {

constexpr double kGap = 1.5;            // in median intervals
constexpr double kTolerance = 0.25;     // of dt: how far an image may be from where it is due
constexpr double kRateTolerance = 0.1;  // of dt: how far the usual interval may be from it

bool isEarlier(const TimedTorque& a, const TimedTorque& b) { return a.time < b.time; }

template <class Item>
std::vector<ros::Time> timesOf(const std::vector<Item>& items) {
  std::vector<ros::Time> times;
  for (const Item& item : items) times.push_back(item.time);
  return times;
}

/// [s]; 0 if there are fewer than two.
double medianInterval(const std::vector<ros::Time>& times) {
  std::vector<double> intervals;
  for (size_t i = 1; i < times.size(); ++i) {
    intervals.push_back(secondsBetween(times[i - 1], times[i]));
  }
  if (intervals.empty()) return 0.0;
  // The lower of two middle ones: a gap only ever lengthens an interval.
  const auto middle = intervals.begin() + (intervals.size() - 1) / 2;
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// The position of the time that is nearest to another.
/// @param times  sorted, at least one
std::size_t nearest(const std::vector<ros::Time>& times, const ros::Time& time) {
  const auto later = std::lower_bound(times.begin(), times.end(), time);
  const auto at = static_cast<std::size_t>(later - times.begin());
  if (at == 0) return at;
  return later == times.end() || secondsBetween(times[at - 1], time) < secondsBetween(time, *later)
             ? at - 1
             : at;
}

/// Positions of images dt apart; bool: whether a new segment begins.
std::vector<std::pair<std::size_t, bool>> pickImages(const std::vector<ros::Time>& times,
                                                     double dt) {
  std::vector<std::pair<std::size_t, bool>> picked;
  for (std::size_t image = 0; image < times.size();) {
    if (!picked.empty()) {
      const ros::Time due = times[picked.back().first] + ros::Duration(dt);
      const std::size_t candidate = nearest(times, due);
      if (candidate > picked.back().first &&
          std::abs(secondsBetween(due, times[candidate])) <= kTolerance * dt) {
        picked.emplace_back(candidate, false);
        image = candidate + 1;
        continue;
      }
      const auto after = std::upper_bound(times.begin(), times.end(), due);  // after the gap
      image = std::max(image, static_cast<std::size_t>(after - times.begin()));
      if (image == times.size()) break;
    }
    picked.emplace_back(image, true);
    ++image;
  }
  return picked;
}

/// The images of a camera whose rate does not fit dt are each where the one before lets them be due,
/// so that frames come at another rate, or one by one.
void requireRate(const Pairs& pairs, double apart, double dt) {
  const auto& frames = pairs.frames;
  std::size_t num_alone = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool last = i + 1 == frames.size() || frames[i + 1].new_segment;
    num_alone += frames[i].new_segment && last ? 1 : 0;
  }
  const double interval = pairs.interval();
  const bool fits =
      std::abs(interval - dt) <= kRateTolerance * dt && 4 * num_alone <= frames.size();
  if (fits || frames.size() < 2 || apart <= 0.0) return;
  const double multiple = std::max(1.0, std::floor(dt / apart));
  std::ostringstream text;
  text.precision(3);
  text << "its images come every " << apart << " s, which does not fit data_set/dt = " << dt
       << ": set it (--dt) to a multiple, such as " << multiple * apart << " or "
       << (multiple + 1.0) * apart;
  throw std::runtime_error(text.str());
}

}  // namespace

double Pairs::interval() const { return medianInterval(timesOf(frames)); }

Pairs pairByStamp(const std::vector<TimedImage>& images, std::vector<TimedTorque> torques) {
  const auto byStamp = [](const TimedTorque& a, const TimedTorque& b) { return a.stamp < b.stamp; };
  std::stable_sort(torques.begin(), torques.end(), byStamp);
  for (size_t i = 1; i < torques.size(); ++i) {
    if (torques[i].stamp == torques[i - 1].stamp && torques[i].torque != torques[i - 1].torque) {
      throw std::runtime_error(
          "two different torques of data_set/torque_topic have the stamp " +
          std::to_string(torques[i].stamp.toSec()) +
          " s: stamp each with the image it answers, and record each run of a simulation, whose "
          "time begins anew, in a bag of its own");
    }
  }
  const auto isSame = [](const TimedTorque& a, const TimedTorque& b) { return a.stamp == b.stamp; };
  torques.erase(std::unique(torques.begin(), torques.end(), isSame), torques.end());
  Pairs pairs;
  std::vector<bool> paired(torques.size(), false);
  bool new_segment = true;
  for (const TimedImage& image : images) {
    const auto torque = std::lower_bound(torques.begin(), torques.end(),
                                         TimedTorque{image.stamp, {}, {}, {}}, byStamp);
    if (torque == torques.end() || torque->stamp != image.stamp) {
      pairs.images_without_torque.push_back(image.time);
      new_segment = true;
      continue;
    }
    auto is_paired = paired[static_cast<std::size_t>(torque - torques.begin())];
    if (is_paired) {
      throw std::runtime_error(
          "two different images of data_set/image_topic have the stamp " +
          std::to_string(image.stamp.toSec()) +
          " s: let the camera stamp each image anew, and record each run of a simulation, whose "
          "time begins anew, in a bag of its own");
    }
    is_paired = true;
    pairs.frames.push_back({image.number, image.time, torque->torque, new_segment});
    new_segment = false;
  }
  for (size_t i = 0; i < torques.size(); ++i) {
    if (!paired[i]) pairs.torques_without_image.push_back(torques[i].time);
  }
  const double gap = kGap * pairs.interval();
  for (size_t i = 1; i < pairs.frames.size(); ++i) {
    const double interval = secondsBetween(pairs.frames[i - 1].time, pairs.frames[i].time);
    pairs.frames[i].new_segment = pairs.frames[i].new_segment || interval > gap;
  }
  return pairs;
}

Pairs pairInTime(const std::vector<TimedImage>& images, std::vector<TimedTorque> torques,
                 double dt) {
  const std::vector<ros::Time> image_times = timesOf(images);
  const double apart = medianInterval(image_times);
  if (apart > (1.0 + kTolerance) * dt) {
    std::ostringstream text;
    text << "its images are " << apart << " s apart, and frames must be data_set/dt = " << dt
         << " s apart: make that as long as images are apart, or longer";
    throw std::runtime_error(text.str());
  }
  std::stable_sort(torques.begin(), torques.end(), isEarlier);
  const std::vector<ros::Time> times = timesOf(torques);

  const auto picked = pickImages(image_times, dt);
  Pairs pairs;
  pairs.usual_age = std::max(dt, kGap * medianInterval(times));
  size_t next_torque = 0;  // the first that is not counted yet
  for (size_t i = 0; i < picked.size(); ++i) {
    const TimedImage& image = images[picked[i].first];
    const bool continued = i + 1 < picked.size() && !picked[i + 1].second;
    const ros::Time end =
        continued ? images[picked[i + 1].first].act : image.act + ros::Duration(dt);
    const auto after = std::lower_bound(times.begin(), times.end(), end);
    if (after == times.begin()) {  // before the first torque
      pairs.images_without_torque.push_back(image.time);
      continue;
    }
    const auto last = static_cast<size_t>(after - times.begin()) - 1;
    const double age = secondsBetween(times[last], end);
    pairs.num_held += age > pairs.usual_age ? 1 : 0;
    pairs.longest_held = std::max(pairs.longest_held, age);
    for (; next_torque < times.size() && times[next_torque] < image.act; ++next_torque) {
      if (next_torque != last) pairs.torques_without_image.push_back(times[next_torque]);
    }
    next_torque = std::max(next_torque, last + 1);
    pairs.frames.push_back(
        {image.number, image.time, torques[last].torque, picked[i].second || pairs.frames.empty()});
  }
  pairs.torques_without_image.insert(pairs.torques_without_image.end(),
                                     times.begin() + static_cast<std::ptrdiff_t>(next_torque),
                                     times.end());
  requireRate(pairs, apart, dt);
  return pairs;
}

}  // namespace ddm
