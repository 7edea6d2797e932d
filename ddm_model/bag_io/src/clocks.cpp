// Chooses the times of images and torques: header stamps if reliable, otherwise times of recording.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bag_texts.h"
#include "pairing.h"

namespace ddm {
namespace {

constexpr double kLag = 0.5;          // largest lag that does not matter, in units of dt
constexpr long kMaxDelay = 50;        // longer lags are not due to a camera [samples]
constexpr double kHeldBefore = 60.0;  // longest time from the last torque to the first image [s]
constexpr double kLeap = 1.0;         // a clock that gains more at once has been set [s]
constexpr char kRecordingTimes[] = ": the times at which messages were recorded count instead";

/// @return a lag as text, such as "0.5 s after"
std::string lagText(double lag) {
  return secondsText(std::abs(lag)) + (lag < 0.0 ? " before" : " after");
}

/// @return median time from the stamp of a message to its recording [s]
template <class Message>
double usualLag(const std::vector<Message>& messages) {
  std::vector<double> lags;
  for (const Message& message : messages) {
    lags.push_back(secondsBetween(message.stamp, message.recorded));
  }
  return median(lags);
}

/// Sorts messages by time of recording. Invalid times are refused, because they cannot be compared.
/// Messages are also refused if the clock of the recording was set back to a time that it had had
/// before, because their order cannot be told from their times. Merged bags may be in any order.
/// @param messages  in the order of the file
template <class Message>
void sortByRecording(const char* what, std::vector<Message>* messages) {
  using Span = std::pair<ros::Time, ros::Time>;  // first and last time
  std::vector<Span> spans;                       // a new one where the clock was set back
  for (const Message& message : *messages) {
    const std::uint32_t nsec = std::max(message.stamp.nsec, message.recorded.nsec);
    if (nsec >= 1000000000U) {
      refuseBag("a time of its ", what, " has ", nsec, " nanoseconds in its second: it is damaged");
    }
    const ros::Time& time = message.recorded;
    if (spans.empty() || secondsBetween(time, spans.back().second) > kLeap) {
      spans.emplace_back(time, time);
    }
    spans.back() = {std::min(spans.back().first, time), std::max(spans.back().second, time)};
  }
  std::sort(spans.begin(), spans.end());
  const auto before = std::adjacent_find(
      spans.begin(), spans.end(), [](const Span& a, const Span& b) { return b.first < a.second; });
  if (before != spans.end()) {
    const Span& again = *std::next(before);
    refuseBag("its ", what, " were recorded from ", timeText(before->first), " to ",
              timeText(before->second), " and again from ", timeText(again.first), " to ",
              timeText(again.second), ", by a clock that was set back: ", kOneRunPerBag);
  }
  std::stable_sort(messages->begin(), messages->end(),
                   [](const Message& a, const Message& b) { return a.recorded < b.recorded; });
}

/// Removes images that were recorded twice.
void removeCopies(double dt, std::vector<BagImage>* images) {
  std::map<std::pair<ros::Time, std::size_t>, ros::Time> seen;
  const auto isAgain = [&](const BagImage& image) {
    const auto added = seen.emplace(std::make_pair(image.stamp, image.content), image.recorded);
    // A robot at rest whose camera clock stands still also repeats an image, but later.
    return !added.second &&
           (dt == 0.0 || secondsBetween(added.first->second, image.recorded) < 0.5 * dt);
  };
  images->erase(std::remove_if(images->begin(), images->end(), isAgain), images->end());
}

/// @return description of the first place where stamps decrease in the order of recording; empty:
///         none
template <class Message>
std::string stepBack(const std::vector<Message>& messages, const std::string& what) {
  const auto isBack = [](const Message& a, const Message& b) { return b.stamp < a.stamp; };
  const auto at = std::adjacent_find(messages.begin(), messages.end(), isBack);
  return at == messages.end() ? ""
                              : textOf("the ", what, " stamps go back from ", timeText(at->stamp),
                                       " to ", timeText(std::next(at)->stamp));
}

/// @return why the stamps are unreliable; empty if they are reliable. Messages that were recorded
///         late are no fault
/// @param longest_still  time for which several messages may have the same stamp [s]
template <class Message>
std::string clockFault(const std::vector<Message>& messages, const std::string& what,
                       double longest_still) {
  if (std::any_of(messages.begin(), messages.end(),
                  [](const Message& message) { return message.stamp.isZero(); })) {
    return "some " + what + "s have no stamp";
  }
  const std::string fault = stepBack(messages, what);
  if (!fault.empty()) return fault;
  const bool all_same = messages.size() > 1 && messages.front().stamp == messages.back().stamp;
  std::size_t same_since = 0;  // first message with the current stamp
  for (std::size_t i = 1; i < messages.size(); ++i) {
    const Message &before = messages[i - 1], &message = messages[i];
    const double gained = secondsBetween(before.stamp, message.stamp);
    if (gained - secondsBetween(before.recorded, message.recorded) > kLeap) {
      return textOf("the ", what, " stamps leap from ", timeText(before.stamp), " to ",
                    timeText(message.stamp));
    }
    if (gained > 0.0) same_since = i;
    const double still = secondsBetween(messages[same_since].recorded, message.recorded);
    if (all_same || (same_since < i && still >= longest_still)) {
      return "the " + what + " stamps stand still at " + timeText(message.stamp);
    }
  }
  return "";
}

/// Pairs images with torques that do not name their image: by stamps if both have reliable ones,
/// otherwise by times of recording.
/// @param images, torques  in the order of their recording
Pairs pairByClocks(std::vector<BagImage> images, std::vector<BagTorque> torques, double dt) {
  std::vector<std::string> notes;
  const auto faultOf = [&notes](const auto& messages, const std::string& what, double still) {
    const std::string fault = clockFault(messages, what, still);
    const bool any_stamp = std::any_of(messages.begin(), messages.end(),
                                       [](const auto& message) { return !message.stamp.isZero(); });
    if (!fault.empty() && any_stamp) notes.push_back(fault + kRecordingTimes);
    return !fault.empty();
  };
  const bool image_fault = faultOf(images, "image", /*still=*/0.0);
  // Drivers publish torques faster than they measure them, so that stamps repeat.
  const bool torque_fault = faultOf(torques, "torque", /*still=*/kLeap);
  const double image_lag = usualLag(images), torque_lag = usualLag(torques);
  // A short lag between stamp and recording does not matter. A long one may be that of the
  // recorder, which then also delays the torques.
  const bool lags = image_fault || std::abs(image_lag) > kLag * dt;

  const auto pairBy = [&](bool stamps) {
    if (!stamps && images.size() > 1 && images.front().recorded == images.back().recorded) {
      refuseBag(
          "all its images were recorded at ", timeText(images.front().recorded),
          ", as in a bag that was written again, and not all stamps can be trusted: write it with "
          "the times of the original, or stamp images and torques by one clock");
    }
    for (BagImage& image : images) {
      image.time = image_fault ? image.recorded : image.stamp;
      image.act = stamps || !lags ? image.stamp : image.recorded;
    }
    for (BagTorque& torque : torques) torque.time = stamps ? torque.stamp : torque.recorded;
    const auto span =
        std::minmax_element(torques.begin(), torques.end(),
                            [](const BagTorque& a, const BagTorque& b) { return a.time < b.time; });
    const ros::Time first = images.front().act, last = images.back().act;
    Pairs pairs;
    // All recorded times are of one clock: a torque recorded before the first image is still in
    // force.
    if (span.first->time < last + ros::Duration(dt) &&
        secondsBetween(span.second->time, first) <= (stamps ? 0.0 : kHeldBefore)) {
      pairs = pairInTime(images, torques, dt);
    }
    if (pairs.frames.empty() && !stamps) {
      refuseBag("of its ", images.size(), " images and ", torques.size(),
                " torques, images come from ", timeText(first), " to ", timeText(last),
                " and torques from ", timeText(span.first->time), " to ",
                timeText(span.second->time), ": record both at once, stamped by one clock");
    }
    const bool two_clocks = !stamps && lags && !image_fault;
    pairs.lag = two_clocks ? images.front().recorded.toSec() - images.front().stamp.toSec() : 0.0;
    return pairs;
  };
  const bool by_stamps = !image_fault && !torque_fault;
  Pairs pairs = pairBy(by_stamps);
  if (pairs.frames.empty()) {
    notes.push_back(
        std::string("the stamps of images and torques do not overlap, as of two clocks") +
        kRecordingTimes);
    pairs = pairBy(/*stamps=*/false);
  } else if (by_stamps && std::abs(image_lag - torque_lag) > dt) {
    notes.push_back("images were recorded " + lagText(image_lag) + " their stamps and torques " +
                    lagText(torque_lag) +
                    " theirs: stamps count, so let both be stamped by one clock");
  } else if (!image_fault && !by_stamps && lags) {
    const long frames = std::lround(image_lag / dt);
    notes.push_back(textOf("images were recorded ", lagText(image_lag),
                           " their stamps, and the torques have no stamps that can be trusted",
                           kRecordingTimes));
    if (frames >= 1 && frames <= kMaxDelay) {
      notes.back() +=
          textOf("; if it is not the recorder that was late but the camera, raise model/order by ",
                 frames);
    }
  }
  pairs.notes.insert(pairs.notes.begin(), notes.begin(), notes.end());
  return pairs;
}

}  // namespace

Pairs pairUp(std::vector<BagImage> images, std::vector<BagTorque> torques, double dt) {
  sortByRecording("images", &images);
  sortByRecording("torques", &torques);
  removeCopies(dt, &images);
  if (images.empty()) refuseBag("its image topic has no message: leave this bag out");
  // BagWriter writes a message at its stamp, other recorders at its arrival.
  const bool of_others =
      dt > 0.0 || std::any_of(images.begin(), images.end(), [](const BagImage& image) {
        return image.recorded != std::max(image.stamp, ros::TIME_MIN);
      });
  Pairs pairs;
  if (dt > 0.0) {
    pairs = pairByClocks(images, torques, dt);
  } else {
    const std::string fault = stepBack(images, "image");
    for (BagImage& image : images) image.time = fault.empty() ? image.stamp : image.recorded;
    for (BagTorque& torque : torques) torque.time = fault.empty() ? torque.stamp : torque.recorded;
    pairs = pairByStamp(images, torques);
    if (!fault.empty())
      pairs.notes.push_back(fault + ": images are in the order of their recording");
    const std::size_t images_alone = pairs.images_without_torque.size();
    const std::size_t torques_alone = pairs.torques_without_image.size();
    if (of_others && images_alone + torques_alone > 0) {
      pairs.notes.push_back(textOf(
          images_alone, " of ", images.size(), " images have no torque with their stamp and ",
          torques_alone, " of ", pairs.frames.size() + torques_alone,
          " torques no image: they are dropped; stamp each torque with the image it answers"));
    }
  }
  if (pairs.frames.empty()) {
    refuseBag(
        "of its ", images.size(), " images and ", torques.size(),
        " torques, no two have the same header stamp: stamp each torque with the image it answers");
  }
  pairs.of_others = of_others;
  std::vector<std::size_t> begins;  // first samples of all segments but the first
  for (std::size_t i = 1; i < pairs.frames.size(); ++i) {
    if (pairs.frames[i].new_segment) begins.push_back(i);
  }
  if (of_others && !begins.empty()) {
    pairs.notes.push_back(textOf("frames are missing or late at ", begins.size(),
                                 " place(s), the first after ",
                                 timeText(pairs.frames[begins.front() - 1].time),
                                 ", so that it is split into ", begins.size() + 1, " segments"));
  }
  return pairs;
}

}  // namespace ddm
