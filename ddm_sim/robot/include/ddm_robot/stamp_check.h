// Whether the stamps of a sensor can be trusted: each is compared with the arrival of its message.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "ddm_robot/clocks.h"

namespace ddm {

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

}  // namespace ddm
