// What is wrong with a camera. YAML block `camera:`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace ddm {

/// Sensor faults, see Camera. All 0: a perfect camera.
struct CameraOptions {
  double noise_std = 0.0;         ///< standard deviation of each pixel in each frame [grey]
  double brightness_drift = 0.0;  ///< amplitude of a slow change of brightness [-]
  double clutter = 0.0;           ///< largest grey value of a static background [grey]
  int delay = 0;                  ///< so many frames late [-]
  double drop_rate = 0.0;         ///< probability that a frame is lost [-]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("noise_std", noise_std);
    visitor("brightness_drift", brightness_drift);
    visitor("clutter", clutter);
    visitor("delay", delay);
    visitor("drop_rate", drop_rate);
  }

  /// Everything wrong with these values, in words a user can act on. Empty means valid.
  std::vector<std::string> problems() const;
};

}  // namespace ddm
