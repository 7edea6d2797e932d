// Pairs images with the torques that acted after them.
// SPDX-License-Identifier: BSD-3-Clause
#include "pairing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "bag_texts.h"

namespace ddm {
namespace {

constexpr double kGap = 1.5;            // gap / median interval
constexpr double kTolerance = 0.25;     // tolerance of the time of an image / dt
constexpr double kRateTolerance = 0.1;  // tolerance of the median interval / dt
constexpr double kFewImages = 10.0;     // dt / time between images, if it should be reported

template <class Item>
std::vector<ros::Time> timesOf(const std::vector<Item>& items) {
  std::vector<ros::Time> times;
  for (const Item& item : items) times.push_back(item.time);
  return times;
}

std::vector<double> intervalsOf(const std::vector<ros::Time>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) {
    intervals.push_back(secondsBetween(times[i - 1], times[i]));
  }
  return intervals;
}

/// @return hash of the time and content of an image, and of its torque if both have one stamp
std::size_t idOf(const BagImage& image, const std::vector<double>& torque) {
  std::string bytes = textOf(timeText(image.time), " ", image.content);
  bytes.append(reinterpret_cast<const char*>(torque.data()), torque.size() * sizeof(double));
  return std::hash<std::string>()(bytes);
}

/// @return index of the time that is nearest to `time`
/// @param times  sorted, at least one
std::size_t nearest(const std::vector<ros::Time>& times, const ros::Time& time) {
  const auto later = std::lower_bound(times.begin(), times.end(), time);
  const auto at = static_cast<std::size_t>(later - times.begin());
  if (at == 0) return at;
  return later == times.end() || secondsBetween(times[at - 1], time) < secondsBetween(time, *later)
             ? at - 1
             : at;
}

/// @return indices of images dt apart, each with whether a new segment begins there. If the camera
///         takes an image every dt, these are all images, even if their times jitter
/// @param apart  median time between images [s]
std::vector<std::pair<std::size_t, bool>> pickImages(const std::vector<ros::Time>& times,
                                                     double apart, double dt) {
  std::vector<std::pair<std::size_t, bool>> picked;
  if (std::abs(apart - dt) <= kRateTolerance * dt) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      picked.emplace_back(i, i == 0 || secondsBetween(times[i - 1], times[i]) > kGap * dt);
    }
    return picked;
  }
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
      // The next segment begins with the first image after the gap.
      const auto after = std::upper_bound(times.begin(), times.end(), due);
      image = std::max(image, static_cast<std::size_t>(after - times.begin()));
      if (image == times.size()) break;
    }
    picked.emplace_back(image, true);
    ++image;
  }
  return picked;
}

/// Refuses images whose rate does not fit dt. Each of them is within the tolerance of the one
/// before, but samples have another rate, or stand alone in their segments.
/// @param times  of all images
/// @param apart  median time between images [s]
void requireRate(const Pairs& pairs, const std::vector<ros::Time>& times, double apart, double dt) {
  const auto& frames = pairs.frames;
  std::size_t num_alone = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool last = i + 1 == frames.size() || frames[i + 1].new_segment;
    num_alone += frames[i].new_segment && last ? 1 : 0;
  }
  const double interval = medianInterval(pairs.times());
  const bool fits =
      std::abs(interval - dt) <= kRateTolerance * dt && 4 * num_alone <= frames.size();
  if (fits || frames.size() < 2 || apart <= 0.0) return;
  if (std::abs(std::round(dt / apart) * apart - dt) <= kRateTolerance * dt) {
    const std::vector<double> intervals = intervalsOf(times);
    const auto span = std::minmax_element(intervals.begin(), intervals.end());
    refuseBag("its images come irregularly, from ", secondsText(*span.first), " to ",
              secondsText(*span.second),
              " apart, so that few of them are data_set/dt = ", secondsText(dt),
              " apart: stamp images in the camera, and look for images that are lost on the way");
  }
  const double multiple = std::max(1.0, std::floor(dt / apart));
  refuseBag("its images come every ", secondsText(apart),
            ", which does not fit data_set/dt = ", secondsText(dt),
            ": set it (--dt) to a multiple, such as ", secondsText(multiple * apart), " or ",
            secondsText((multiple + 1.0) * apart));
}

}  // namespace

Pairs pairByStamp(const std::vector<BagImage>& images, std::vector<BagTorque> torques) {
  const auto byStamp = [](const BagTorque& a, const BagTorque& b) { return a.stamp < b.stamp; };
  std::stable_sort(torques.begin(), torques.end(), byStamp);
  const auto isSame = [](const BagTorque& a, const BagTorque& b) {
    if (a.stamp == b.stamp && a.torque != b.torque) {
      refuseBag("two different torques of data_set/torque_topic have the stamp ", timeText(a.stamp),
                ": stamp each with the image it answers, and ", kOneRunPerBag);
    }
    return a.stamp == b.stamp;
  };
  torques.erase(std::unique(torques.begin(), torques.end(), isSame), torques.end());
  Pairs pairs;
  std::vector<bool> paired(torques.size(), false);
  bool new_segment = true;
  for (const BagImage& image : images) {
    const auto torque =
        std::lower_bound(torques.begin(), torques.end(), BagTorque{image.stamp, {}, {}}, byStamp);
    if (torque == torques.end() || torque->stamp != image.stamp) {
      pairs.images_without_torque.push_back(image.time);
      new_segment = true;
      continue;
    }
    auto is_paired = paired[static_cast<std::size_t>(torque - torques.begin())];
    if (is_paired) {
      refuseBag("two different images of data_set/image_topic have the stamp ",
                timeText(image.stamp), ": let the camera stamp each image anew, and ",
                kOneRunPerBag);
    }
    is_paired = true;
    pairs.frames.push_back({image.number, image.time, torque->torque, new_segment});
    pairs.ids.push_back(idOf(image, torque->torque));
    new_segment = false;
  }
  for (std::size_t i = 0; i < torques.size(); ++i) {
    if (!paired[i]) pairs.torques_without_image.push_back(torques[i].time);
  }
  const double gap = kGap * medianInterval(pairs.times());
  for (std::size_t i = 1; i < pairs.frames.size(); ++i) {
    const double interval = secondsBetween(pairs.frames[i - 1].time, pairs.frames[i].time);
    pairs.frames[i].new_segment = pairs.frames[i].new_segment || interval > gap;
  }
  return pairs;
}

Pairs pairInTime(const std::vector<BagImage>& images, std::vector<BagTorque> torques, double dt) {
  const std::vector<ros::Time> image_times = timesOf(images);
  const double apart = medianInterval(image_times);
  if (apart > (1.0 + kTolerance) * dt) {
    refuseBag("its images are ", apart, " s apart, and frames must be data_set/dt = ", dt,
              " s apart: make that as long as images are apart, or longer");
  }
  std::stable_sort(torques.begin(), torques.end(),
                   [](const BagTorque& a, const BagTorque& b) { return a.time < b.time; });
  const std::vector<ros::Time> times = timesOf(torques);
  const double usual_age = std::max(dt, kGap * medianInterval(times));
  const auto picked = pickImages(image_times, apart, dt);
  Pairs pairs;
  if (images.size() > 1 && (picked.size() < 2 || dt > kFewImages * apart)) {
    const std::string text =
        textOf("its images come every ", secondsText(apart),
               ", so that data_set/dt = ", secondsText(dt), " uses ", picked.size(), " of ",
               images.size(), ": set it (--dt) to the time between samples, in seconds");
    if (picked.size() < 2) refuseBag(text);
    pairs.notes.push_back(text);
  }
  for (const BagImage& image : images) pairs.ids.push_back(idOf(image, /*torque=*/{}));
  std::size_t next_torque = 0;  // first torque that is not used or dropped yet
  std::size_t num_held = 0;     // samples whose torque is older than usual
  double longest_held = 0.0;    // age of the oldest torque at the end of its sample [s]
  for (std::size_t i = 0; i < picked.size(); ++i) {
    const BagImage& image = images[picked[i].first];
    const bool continued = i + 1 < picked.size() && !picked[i + 1].second;
    const ros::Time end =
        continued ? images[picked[i + 1].first].act : image.act + ros::Duration(dt);
    const auto after = std::lower_bound(times.begin(), times.end(), end);
    if (after == times.begin()) {  // there is no torque before the end of this sample
      pairs.images_without_torque.push_back(image.time);
      continue;
    }
    const auto last = static_cast<std::size_t>(after - times.begin()) - 1;
    const double age = secondsBetween(times[last], end);
    num_held += age > usual_age ? 1 : 0;
    longest_held = std::max(longest_held, age);
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
  requireRate(pairs, image_times, apart, dt);
  if (!pairs.images_without_torque.empty()) {
    pairs.notes.push_back(
        textOf(pairs.images_without_torque.size(),
               " image(s) before the first torque were dropped: nothing says what "
               "acted then"));
  }
  if (num_held > 0) {
    pairs.notes.push_back(textOf(num_held, " of ", pairs.frames.size(),
                                 " frames have a torque that is older than ",
                                 secondsText(usual_age), ", at most ", secondsText(longest_held),
                                 ": a torque counts until the next one"));
  }
  return pairs;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double medianInterval(const std::vector<ros::Time>& times) {
  const std::vector<double> intervals = intervalsOf(times);
  return intervals.empty() ? 0.0 : median(intervals);
}

std::vector<ros::Time> Pairs::times() const { return timesOf(frames); }

}  // namespace ddm
