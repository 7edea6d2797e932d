// The messages of one bag that concern us, and how they become frames.
// SPDX-License-Identifier: BSD-3-Clause
#include "trial_messages.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

namespace ddm {
namespace {

constexpr double kLag = 0.5;          // of dt
constexpr long kMaxDelay = 50;        // that training/max_delay may have [frames]
constexpr double kHeldBefore = 60.0;  // [s]: a torque from before the first image may hold
constexpr double kLeap = 1.0;         // [s]: a clock that gains more at once was set
constexpr int kFewGreyValues = 64;    // of 256: what 14 bits of 16 leave
constexpr char kRecordingTimes[] = ": the times at which messages were recorded count instead";

std::string textOf(const ros::Time& time) { return std::to_string(time.toSec()) + " s"; }

std::string textOf(double seconds) {
  char text[400];  // the largest number has 309 digits
  std::snprintf(text, sizeof(text), std::abs(seconds) < 1000.0 ? "%.3g s" : "%.0f s", seconds);
  return text;
}

/// "0.5 s after"
std::string lagText(double lag) {
  return textOf(std::abs(lag)) + (lag < 0.0 ? " before" : " after");
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

/// A few messages may be late; only most of them tell of a clock.
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
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
  if (!by_stamp && num_zero > 0) return std::to_string(num_zero) + " image(s) have no stamp";
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

/// Likewise of the torques, which are in the order of their recording. Some may have the same stamp,
/// since drivers publish faster than they measure; and a recorder that was late gains no time.
std::string TrialMessages::torqueClockFault() const {
  std::size_t same_since = 0;  // the first of those with the same stamp
  for (std::size_t i = 0; i < torques_.size(); ++i) {
    if (torques_[i].stamp.isZero()) return "torques have no stamps";
    if (i == 0) continue;
    const TimedTorque &before = torques_[i - 1], &torque = torques_[i];
    const double gained = secondsBetween(before.stamp, torque.stamp);
    if (gained < 0.0 || gained - secondsBetween(before.recorded, torque.recorded) > kLeap) {
      return std::string("the torque stamps ") + (gained < 0.0 ? "go back" : "leap") + " from " +
             textOf(before.stamp) + " to " + textOf(torque.stamp);
    }
    if (gained > 0.0) same_since = i;
    if (secondsBetween(torques_[same_since].recorded, torque.recorded) > kLeap) {
      return "the torque stamps stand still at " + textOf(torque.stamp);
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
    image_lags.push_back(secondsBetween(image.stamp, image.recorded));
  }
  for (const TimedTorque& torque : torques_) {
    torque_lags.push_back(secondsBetween(torque.stamp, torque.recorded));
  }
  const double image_lag = median(image_lags), torque_lag = median(torque_lags);
  // A short delay of the camera does not matter. A long one may be that of the recorder, which then
  // is that of the torques, too.
  const bool lags = !image_fault.empty() || std::abs(image_lag) > kLag * dt;

  const auto pairUp = [&](bool by_stamps) {
    const Image &front = all_images_[order.front()], &back = all_images_[order.back()];
    if (!by_stamps && order.size() > 1 && front.recorded == back.recorded) {
      throw std::runtime_error(
          "all its images were recorded at " + textOf(front.recorded) +
          ", as in a bag that was written again, and not all stamps can be trusted: write it with "
          "the times of the original, or stamp images and torques by one clock");
    }
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
    // One recorder has one clock: a torque that it took before the first image is still in force.
    if (span.first->time < last + ros::Duration(dt) &&
        secondsBetween(span.second->time, first) <= (by_stamps ? 0.0 : kHeldBefore)) {
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
    note("images were recorded " + lagText(image_lag) + " their stamps and torques " +
         lagText(torque_lag) + " theirs: stamps count, so let both be stamped by one clock");
  } else if (image_fault.empty() && !by_stamps && lags) {
    const long frames = std::lround(image_lag / dt);
    note("images were recorded " + lagText(image_lag) +
         " their stamps, and the torques have no stamps that can be trusted" + kRecordingTimes +
         (frames > kMaxDelay || frames < 1
              ? ""
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
  // BagWriter records a message at its stamp.
  of_others_ = dt > 0.0 || std::any_of(order.begin(), order.end(), [this](auto number) {
                 const Image& image = all_images_[number];
                 return image.recorded != std::max(image.stamp, ros::TIME_MIN);
               });
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
  const std::size_t images_alone = pairs_.images_without_torque.size();
  const std::size_t torques_alone = pairs_.torques_without_image.size();
  if (dt == 0.0 && of_others_ && images_alone + torques_alone > 0) {
    note(std::to_string(images_alone) + " of " + std::to_string(order.size()) +
         " images have no torque with their stamp and " + std::to_string(torques_alone) + " of " +
         std::to_string(pairs_.frames.size() + torques_alone) +
         " torques no image: they are dropped; stamp each torque with the image it answers");
  }
  noteGaps();
  if (pairs_.num_held > 0) {
    note(std::to_string(pairs_.num_held) + " of " + std::to_string(pairs_.frames.size()) +
         " frames have a torque that is older than " + textOf(pairs_.usual_age) + ", at most " +
         textOf(pairs_.longest_held) + ": a torque counts until the next one");
  }
}

void TrialMessages::noteGaps() {
  if (!of_others_) return;
  const auto& frames = pairs_.frames;
  std::size_t num_gaps = 0;
  ros::Time first;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].new_segment && num_gaps++ == 0) first = frames[i - 1].time;
  }
  if (num_gaps == 0) return;
  note("frames are missing at " + std::to_string(num_gaps) + " place(s), the first after " +
       textOf(first) + ", so that it is split into " + std::to_string(num_gaps + 1) + " segments");
}

void TrialMessages::takeImage(std::size_t number, const sensor_msgs::Image& image,
                              const std::string& encoding) {
  if (image.data.empty()) return takeBrokenImage(number, "it has no pixels");
  const std::size_t frame = frame_of_.at(number);
  const std::string time = textOf(pairs_.frames[frame].time);
  const std::string size = std::to_string(image.width) + "x" + std::to_string(image.height) + " ";
  const std::string camera = size + encoding;
  if (camera_.empty()) camera_ = camera;
  // What a compressed image is called does not change its pixels.
  const bool compressed = encoding != image.encoding;
  if (camera != camera_ && !(compressed && camera_.compare(0, size.size(), size) == 0)) {
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
  const auto since = [&begin](const ros::Time& time) { return secondsBetween(begin, time); };
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
    if (of_others_) {
      std::string bytes(greys_[i].begin(), greys_[i].end());
      bytes.append(reinterpret_cast<const char*>(frame.torque.data()),
                   frame.torque.size() * sizeof(double));
      content.frame_ids.push_back(std::hash<std::string>()(bytes + textOf(frame.time)));
    }
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
  content.notes = notes_;
  if (of_others_ && content.data.torques().isZero(0.0)) {
    content.notes.emplace_back("all its torques are 0: record what commands the motors");
  }
  if (!goal_.empty()) content.data.setGoal(goal_);
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
