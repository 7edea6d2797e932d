// Stamps of a sensor: whether they can be trusted, and which images of a camera are acted on.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace ddm {

// Two kinds of time, which cannot be mixed up: one guards a motor, the other pairs messages.

/// Of the monotonic clock, which nobody can set: all deadlines of the motor.
using SteadyTime = std::chrono::steady_clock::time_point;

/// Header stamp, since the epoch of the camera's clock: pairs an image with its torque and chooses
/// the images that are acted on. It may shorten a deadline, never extend one.
using Stamp = std::chrono::nanoseconds;

inline double toSeconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

inline std::chrono::nanoseconds fromSeconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

/// Refuses images whose stamps jump, and finds out how long an accepted one was on its way.
///
///   offset = stamp - arrival
///
/// A transport can only delay an image, which lowers its offset; clocks that drift apart change it
/// slowly. An offset that is suddenly higher than all before means that the camera's clock was set
/// forward. Refused are:
///
///   ahead         offset > highest offset so far + dt
///   out of order  stamp <= stamp of the last image that was accepted
///   not set       for the first image: stamp and the clock of this machine differ by more than dt
///
/// The tolerance is one dt because a stamp that is ahead by less hides at most one dt of the images
/// after it, which costs no more than a lost image. An image that comes late is accepted, however
/// late, and so is the next one in time. A refused image changes nothing here: as soon as the
/// camera's clock is right again its images are accepted. A clock that stays wrong needs restart().
///
/// Joint states are judged in the same way.
class StampCheck {
 public:
  /// @param dt      tolerance, > 0: one time step for images [s]
  /// @param sensor  for messages: what sets the stamps
  /// @param item    for messages: what carries the stamps
  explicit StampCheck(double dt, std::string sensor = "camera", std::string item = "an image")
      : dt_(fromSeconds(dt)), sensor_(std::move(sensor)), item_(std::move(item)) {}

  /// Compares a stamp with the clock of this machine.
  /// @param clock  of this machine when the image arrived, since its epoch
  /// @return       what is wrong; empty: they differ by no more than the tolerance
  std::string compare(Stamp clock, Stamp stamp) const;

  /// To be called for each image.
  /// @return why it is refused; empty: accepted
  std::string take(SteadyTime arrival, Stamp clock, Stamp stamp);

  /// When the camera took the last image that was accepted: its arrival, less the time that it was
  /// on its way longer than usual. The usual time is the median over recent images and grows no
  /// faster than clocks drift, so images over a congested link stay late for as long as that lasts.
  SteadyTime taken() const { return taken_; }

  /// The next image counts as the first.
  void restart();

  /// Images refused since the start.
  int numRefused() const { return num_refused_; }

 private:
  std::string refusal(SteadyTime arrival, Stamp clock, Stamp stamp) const;

  std::chrono::nanoseconds dt_;
  std::string sensor_;
  std::string item_;
  std::optional<Stamp> last_;   // empty: none was accepted yet
  Stamp highest_{0};            // offset
  std::deque<Stamp> offsets_;   // of recent images
  std::optional<Stamp> usual_;  // offset
  SteadyTime arrival_;
  SteadyTime taken_;
  int num_refused_ = 0;
};

/// Chooses the images of a camera that are acted on, because the camera has a rate of its own and
/// the loop has its time step: of all images the one that comes nearest to dt after the last one.
///
/// An image is judged when it comes, so the chosen one is the newest and not a moment old. With dt a
/// whole multiple of the camera's period T all steps are equally long, whatever the jitter of stamps
/// below T / 2; otherwise they are round(dt / T) T, still equally long.
class ImagePicker {
 public:
  /// @param dt  time step, > 0 [s]
  explicit ImagePicker(double dt) : dt_(dt) {}

  /// To be called for each image.
  /// @return whether to act on it; never for one that is not newer than all since restart()
  bool pick(Stamp stamp);

  /// The next image will be picked, whatever its stamp.
  void restart() { last_image_.reset(); }

  /// Time between images that are picked [s]; 0 if it is not known yet.
  double step() const;

 private:
  double dt_;
  std::optional<Stamp> last_image_;  // empty: none since restart()
  Stamp last_pick_{0};
  std::deque<Stamp> intervals_;  // between the latest images
  double period_ = 0.0;          // T, their median: a lost image or a pause must not count [s]
};

}  // namespace ddm
