// Which frames of a camera are acted on: it has a rate of its own, the loop has its time step.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "ddm_robot/clocks.h"

namespace ddm {

/// Of all frames the one that comes nearest to dt after the last one picked.
///
/// A frame is judged when it comes, so the one picked is the newest there is and not a moment old.
/// With dt a whole multiple of the camera's period T all steps are equally long, whatever the
/// jitter of stamps below T / 2; otherwise they are round(dt / T) T, still equally long.
class FramePicker {
 public:
  /// @param dt  time step, > 0 [s]
  explicit FramePicker(double dt) : dt_(dt) {}

  /// To be called for each frame.
  /// @return whether to act on it; never for one that is not newer than all since restart()
  bool pick(Stamp stamp);

  /// The next frame will be picked, whatever its stamp.
  void restart();

  /// Time between frames that are picked, as far as it is known [s]; 0: not yet.
  double step() const;

 private:
  double dt_;
  std::optional<Stamp> last_frame_;  // empty: none since restart()
  Stamp last_pick_{0};
  std::deque<double> intervals_;  // between the latest frames [s]
  double period_ = 0.0;           // T, their median: a lost frame or a pause must not count [s]
};

}  // namespace ddm
