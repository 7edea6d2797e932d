// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

constexpr double kMost = 0.9;       // of the images, or torques
constexpr double kLag = 0.5;        // of dt
constexpr long kMaxDelay = 50;      // that training/max_delay may have [frames]
constexpr double kLeap = 1.0;       // [s]: a clock that gains more at once was set
constexpr int kFewGreyValues = 64;  // of 256: what 14 bits of 16 leave
constexpr char kRecordingTimes[] = ": the times at which messages were recorded count instead";

std::string textOf(const ros::Time& time) { return std::to_string(time.toSec()) + " s"; }

std::string textOf(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g s", seconds);
  return text;
}

/// Times are the order of the frames, so they must be times that can be compared.
void requireTime(const ros::Time& time, const std::string& what) {
  if (time.nsec < 1000000000U) return;
  throw std::runtime_error("the stamp of " + what + " has " + std::to_string(time.nsec) +
                           " nanoseconds in its second: it is damaged");
}

std::string spanOf(const ros::Time& first, const ros::Time& last) {
  return "from " + textOf(first) + " to " + textOf(last);
}

/// The value that a share of all does not exceed.
double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

void TrialMessages::takeImageTime(const ros::Time& stamp, const ros::Time& recorded,
                                  std::size_t content) {
  requireTime(stamp, "an image");
  requireTime(recorded, "the record of an image");
  all_images_.push_back({stamp, recorded, content});
}

/// Numbers of the images by the time of their recording, without those that were recorded twice.
std::vector<std::size_t> TrialMessages::imagesInOrder(double dt) const {
  std::vector<std::size_t> order(all_images_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
    return all_images_[a].recorded < all_images_[b].recorded;
  });
  std::map<std::pair<ros::Time, std::size_t>, ros::Time> seen;
  const auto isAgain = [&](std::size_t number) {
    const Image& image = all_images_[number];
    const auto added = seen.emplace(std::make_pair(image.stamp, image.content), image.recorded);
    // A robot at rest whose camera clock stands still sends the same image, too, but later.
    return !added.second &&
           (dt == 0.0 || image.recorded.toSec() - added.first->second.toSec() < 0.5 * dt);
  };
  order.erase(std::remove_if(order.begin(), order.end(), isAgain), order.end());
  return order;
}

/// Why the stamps of the images are no time to go by; empty: they are.
/// @param by_stamp  only their order matters
std::string TrialMessages::clockFault(const std::vector<std::size_t>& order, bool by_stamp) const {
  std::size_t num_zero = 0;
  for (const std::size_t number : order) num_zero += all_images_[number].stamp.isZero() ? 1 : 0;
  if (!by_stamp && num_zero > 0) return std::to_string(num_zero) + " images have no stamp";
  for (std::size_t i = 1; i < order.size(); ++i) {
    const Image &before = all_images_[order[i - 1]], &image = all_images_[order[i]];
    if (image.stamp < before.stamp) {
      return "the image stamps go back from " + textOf(before.stamp) + " to " + textOf(image.stamp);
    }
    if (by_stamp) continue;
    if (image.stamp == before.stamp) {
      return "the image stamps stand still at " + textOf(image.stamp);
    }
    const double gained = (image.stamp.toSec() - before.stamp.toSec()) -
                          (image.recorded.toSec() - before.recorded.toSec());
    if (gained > kLeap) {
      return "the image stamps leap from " + textOf(before.stamp) + " to " + textOf(image.stamp);
    }
  }
  return "";
}

/// Likewise of the torques, which are in the order of their recording.
std::string TrialMessages::torqueClockFault() const {
  for (std::size_t i = 0; i < torques_.size(); ++i) {
    if (torques_[i].stamp.isZero()) return "torques have no stamps";
    if (i == 0) continue;
    const TimedTorque &before = torques_[i - 1], &torque = torques_[i];
    if (before.stamp.toSec() - torque.stamp.toSec() > kLeap) {
      return "the torque stamps go back from " + textOf(before.stamp) + " to " +
             textOf(torque.stamp);
    }
  }
  if (torques_.size() > 1 && torques_.front().stamp == torques_.back().stamp) {
    return "the torque stamps stand still at " + textOf(torques_.front().stamp);
  }
  return "";
}

/// Torques that do not say which image they answer: by stamps where both have them, else by the
/// times of recording, which know only one clock.
void TrialMessages::pairByClocks(double dt, const std::vector<std::size_t>& order) {
  const std::string image_fault = clockFault(order, /*by_stamp=*/false);
  const bool images_have_stamps = std::any_of(order.begin(), order.end(), [this](auto number) {
    return !all_images_[number].stamp.isZero();
  });
  if (!image_fault.empty() && images_have_stamps) note(image_fault + kRecordingTimes);
  const bool torques_have_stamps = std::any_of(
      torques_.begin(), torques_.end(), [](const auto& torque) { return !torque.stamp.isZero(); });
  const std::string torque_fault = torqueClockFault();
  if (!torque_fault.empty() && torques_have_stamps) note(torque_fault + kRecordingTimes);
  std::vector<double> image_lags, torque_lags;
  for (const std::size_t number : order) {
    const Image& image = all_images_[number];
    image_lags.push_back(std::abs(image.recorded.toSec() - image.stamp.toSec()));
  }
  for (const TimedTorque& torque : torques_) {
    torque_lags.push_back(std::abs(torque.recorded.toSec() - torque.stamp.toSec()));
  }
  const double image_lag = quantile(image_lags, kMost), torque_lag = quantile(torque_lags, kMost);
  // A short delay of the camera does not matter. A long one may be that of the recorder, which then
  // is that of the torques, too.
  const bool lags = !image_fault.empty() || image_lag > kLag * dt;

  const auto pairUp = [&](bool by_stamps) {
    const Image& front = all_images_[order.front()];
    const bool two_clocks = !by_stamps && lags && image_fault.empty();
    lag_ = two_clocks ? front.recorded.toSec() - front.stamp.toSec() : 0.0;
    std::vector<TimedImage> images;
    for (const std::size_t number : order) {
      const Image& image = all_images_[number];
      images.push_back({number, image.stamp, image_fault.empty() ? image.stamp : image.recorded,
                        by_stamps || !lags ? image.stamp : image.recorded});
    }
    for (TimedTorque& torque : torques_) torque.time = by_stamps ? torque.stamp : torque.recorded;
    const auto isEarlier = [](const auto& a, const auto& b) { return a.time < b.time; };
    const auto span = std::minmax_element(torques_.begin(), torques_.end(), isEarlier);
    const ros::Time first = images.front().act, last = images.back().act;
    if (span.first->time < last + ros::Duration(dt) && span.second->time >= first) {
      pairs_ = pairInTime(images, torques_, dt);
    }
    if (!pairs_.frames.empty() || by_stamps) return;
    throw std::runtime_error("of its " + std::to_string(order.size()) + " images and " +
                             std::to_string(torques_.size()) + " torques, images come " +
                             spanOf(first, last) + " and torques " +
                             spanOf(span.first->time, span.second->time) +
                             ": record both at once, stamped by one clock");
  };
  const bool by_stamps = image_fault.empty() && torque_fault.empty();
  pairUp(by_stamps);
  if (pairs_.frames.empty()) {
    note("the stamps of images and torques do not overlap, as of two clocks" +
         std::string(kRecordingTimes));
    pairUp(false);
  } else if (by_stamps && std::abs(image_lag - torque_lag) > dt) {
    note("images were recorded " + textOf(image_lag) + " after their stamps and torques " +
         textOf(torque_lag) + " after theirs: stamps count, so let both be stamped by one clock");
  } else if (image_fault.empty() && !by_stamps && lags) {
    const long frames = std::lround(image_lag / dt);
    note("images were recorded " + textOf(image_lag) +
         " after their stamps, and the torques have no stamps" + kRecordingTimes +
         (frames > kMaxDelay ? ""
                             : "; if it is not the recorder that was late but the camera, raise "
                               "training/max_delay to " +
                                   std::to_string(frames)));
  }
}

void TrialMessages::pair(double dt) {
  std::stable_sort(torques_.begin(), torques_.end(),
                   [](const auto& a, const auto& b) { return a.recorded < b.recorded; });
  for (const TimedTorque& torque : torques_) {
    requireTime(torque.stamp, "a torque");
    requireTime(torque.recorded, "the record of a torque");
  }
  const std::vector<std::size_t> order = imagesInOrder(dt);
  if (order.empty()) throw std::runtime_error("its image topic has no message: leave this bag out");
  if (dt > 0.0) {
    pairByClocks(dt, order);
  } else {
    const std::string fault = clockFault(order, /*by_stamp=*/true);
    if (!fault.empty()) note(fault + ": images are in the order of their recording");
    std::vector<TimedImage> images;
    for (const std::size_t number : order) {
      const Image& image = all_images_[number];
      images.push_back({number, image.stamp, fault.empty() ? image.stamp : image.recorded, {}});
    }
    for (TimedTorque& torque : torques_)
      torque.time = fault.empty() ? torque.stamp : torque.recorded;
    pairs_ = pairByStamp(images, torques_);
  }
  if (pairs_.frames.empty()) {
    throw std::runtime_error("of its " + std::to_string(order.size()) + " images and " +
                             std::to_string(torques_.size()) +
                             " torques, no two have the same header stamp: stamp each torque with "
                             "the image it answers");
  }
  for (std::size_t i = 0; i < pairs_.frames.size(); ++i) frame_of_[pairs_.frames[i].image] = i;
  greys_.resize(pairs_.frames.size());
  if (dt > 0.0 && !pairs_.images_without_torque.empty()) {
    note(std::to_string(pairs_.images_without_torque.size()) +
         " image(s) before the first torque were dropped: nothing says what acted then");
  }
  if (pairs_.num_held > 0) {
    note(std::to_string(pairs_.num_held) + " of " + std::to_string(pairs_.frames.size()) +
         " frames have a torque that is older than " + textOf(pairs_.usual_age) + ", at most " +
         textOf(pairs_.longest_held) + ": a torque counts until the next one");
  }
}

void TrialMessages::takeImage(std::size_t number, const sensor_msgs::Image& image,
                              const std::string& encoding) {
  if (image.data.empty()) return takeBrokenImage(number, "it has no pixels");
  const std::size_t frame = frame_of_.at(number);
  const std::string time = textOf(pairs_.frames[frame].time);
  const std::string camera =
      std::to_string(image.width) + "x" + std::to_string(image.height) + " " + encoding;
  if (camera_.empty()) camera_ = camera;
  if (camera != camera_) {
    throw std::runtime_error("the images change from " + camera_ + " to " + camera + " at " + time +
                             ": record one camera setting per bag");
  }
  try {
    greys_[frame] = greyOf(image, image_size_, options_);
  } catch (const std::exception& e) {
    takeBrokenImage(number, e.what());
  }
}

void TrialMessages::takeBrokenImage(std::size_t number, const std::string& fault) {
  if (num_broken_++ > 0) return;
  first_broken_ = "image at " + textOf(pairs_.frames[frame_of_.at(number)].time) + ": " + fault;
}

void TrialMessages::takeGoal(const sensor_msgs::Image& image) {
  try {
    goal_ = greyOf(image, image_size_, options_);
  } catch (const std::invalid_argument& e) {
    throw std::runtime_error(e.what());
  }
}

BagContent TrialMessages::frames() const {
  if (2 * num_broken_ > greys_.size()) throw std::runtime_error(first_broken_);
  const auto torque_dim = static_cast<Eigen::Index>(pairs_.frames.front().torque.size());
  BagContent content{DataSet(image_size_, static_cast<int>(torque_dim)), camera_};
  Pairs whole;
  bool broken = false;
  ros::Time begin;
  const auto since = [&begin](const ros::Time& time) { return (time - begin).toSec(); };
  int darkest = 255, brightest = 0;
  for (std::size_t i = 0; i < greys_.size(); ++i) {
    const Pairs::Frame& frame = pairs_.frames[i];
    broken = broken || frame.new_segment;
    if (greys_[i].empty()) {
      broken = true;
      continue;
    }
    const auto range = std::minmax_element(greys_[i].begin(), greys_[i].end());
    darkest = std::min<int>(darkest, *range.first);
    brightest = std::max<int>(brightest, *range.second);
    if (content.times.empty()) begin = frame.time;
    content.times.push_back(since(frame.time));
    content.data.append(greys_[i],
                        Eigen::Map<const Eigen::VectorXd>(frame.torque.data(), torque_dim), broken);
    broken = false;
    whole.frames.push_back({0, frame.time, {}, false});
  }
  content.interval = whole.interval();
  for (const ros::Time& time : pairs_.images_without_torque) {
    content.images_without_torque.push_back(since(time));
  }
  for (const ros::Time& time : pairs_.torques_without_image) {
    content.torques_without_image.push_back(since(time) - lag_);
  }
  if (!goal_.empty()) content.data.setGoal(goal_);
  content.notes = notes_;
  if (num_broken_ > 0) {
    content.notes.push_back(
        std::to_string(num_broken_) +
        " image(s) cannot be read and leave a gap, the first: " + first_broken_);
  }
  if (brightest - darkest < kFewGreyValues) {
    content.notes.push_back("its images (" + camera_ + ") have grey values from " +
                            std::to_string(darkest) + " to " + std::to_string(brightest) +
                            " of 255, so that little can be told apart: scale 10 or 12 bits, or a "
                            "depth, to the whole range before they are recorded");
  }
  return content;
}

}  // namespace ddm
