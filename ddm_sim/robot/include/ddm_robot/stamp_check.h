// Checks the stamps of a sensor, and selects the camera images for the control loop.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace ddm {

// The two types of time cannot be mixed up: deadlines of the motors use SteadyTime, and the pairing
// of messages uses Stamp.

/// Time of the monotonic clock, which cannot be set. All deadlines of the motors use it.
using SteadyTime = std::chrono::steady_clock::time_point;

/// Header stamp, since the epoch of the camera's clock. Stamps pair an image with its torque and
/// select the images for the control loop. A stamp can shorten a deadline but never extend it.
using Stamp = std::chrono::nanoseconds;

inline double toSeconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

inline std::chrono::nanoseconds fromSeconds(double seconds) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(seconds));
}

/// Refuses images whose stamps jump, and estimates the delay of accepted images.
///
///   offset = stamp - arrival
///
/// A transport can only delay an image, which lowers its offset. Clocks that drift apart change the
/// offset slowly. If an offset is suddenly higher than all previous offsets, the camera's clock was
/// set forward. The following images are refused:
///
///   ahead         offset > highest offset so far + dt
///   out of order  stamp <= stamp of the last image that was accepted
///   not set       for the first image: stamp and the clock of this machine differ by more than dt
///
/// The tolerance is one dt because a stamp that is ahead by less than dt hides at most one dt of
/// the following images, which is no worse than a lost image. Late images are accepted, however
/// late they are, and so are the images after them. A refused image does not change the stored
/// offsets: as soon as the camera's clock is correct again, its images are accepted. If the clock
/// stays wrong, call restart().
///
/// Joint states are checked in the same way.
class StampCheck {
 public:
  /// @param dt      tolerance, > 0; one time step for images [s]
  /// @param sensor  the device that sets the stamps, for messages
  /// @param item    the data with the stamps, for messages
  explicit StampCheck(double dt, std::string sensor = "camera", std::string item = "an image")
      : dt_(fromSeconds(dt)), sensor_(std::move(sensor)), item_(std::move(item)) {}

  /// Compares a stamp with the clock of this machine.
  /// @param clock  clock of this machine at the arrival of the image, since its epoch
  /// @return       description of the difference; empty if it is within the tolerance
  std::string compare(Stamp clock, Stamp stamp) const;

  /// Checks the stamp of an image. Call this function for each image.
  /// @return the reason of the refusal; empty if the image is accepted
  std::string take(SteadyTime arrival, Stamp clock, Stamp stamp);

  /// Estimated time at which the camera took the last accepted image: its arrival minus the part of
  /// its delay that exceeds the usual delay. The usual delay is the median over recent images and
  /// grows no faster than clocks drift. Images therefore count as late for as long as a congested
  /// link delays them.
  SteadyTime taken() const { return taken_; }

  /// Forgets all stamps: the next image counts as the first.
  void restart();

  /// Number of refused images since construction.
  int numRefused() const { return num_refused_; }

 private:
  std::string refusal(SteadyTime arrival, Stamp clock, Stamp stamp) const;

  std::chrono::nanoseconds dt_;
  std::string sensor_;
  std::string item_;
  std::optional<Stamp> last_;   // stamp of the last accepted image; empty before the first
  Stamp highest_{0};            // highest offset so far
  std::deque<Stamp> offsets_;   // offsets of recent images
  std::optional<Stamp> usual_;  // usual offset
  SteadyTime arrival_;
  SteadyTime taken_;
  int num_refused_ = 0;
};

/// Selects the images for the control loop, because the rate of the camera differs from the rate of
/// the loop. Selects the image whose stamp is nearest to dt after the last selected image.
///
/// The decision is made when an image arrives, so the selected image is always the newest one. If
/// dt is a multiple of the camera's period T, all steps have the same length, as long as the jitter
/// of the stamps is below T / 2. Otherwise the steps have the length round(dt / T) T.
class ImagePicker {
 public:
  /// @param dt  time step, > 0 [s]
  explicit ImagePicker(double dt) : dt_(dt) {}

  /// Decides on an image. Call this function for each image.
  /// @return whether the image is selected; never true for an image that is not newer than all
  ///         images since restart()
  bool pick(Stamp stamp);

  /// Forgets the last stamp, so that the next image is selected, whatever its stamp is. The
  /// estimate of the camera's period is kept.
  void restart() { last_image_.reset(); }

  /// Time between selected images [s]; 0 if it is not known yet.
  double step() const;

 private:
  double dt_;
  std::optional<Stamp> last_image_;  // stamp of the last image; empty after restart()
  Stamp last_pick_{0};
  std::deque<Stamp> intervals_;  // between the most recent images
  double period_ = 0.0;          // T [s]; the median, which a lost image or a pause does not change
};

}  // namespace ddm
