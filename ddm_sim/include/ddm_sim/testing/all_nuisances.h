// A camera with all nuisances at once.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ddm_sim/camera_options.h"

namespace ddm {
namespace testing {

inline CameraOptions allNuisances() {
  CameraOptions options;
  options.noise_std = 0.05;
  options.brightness_drift = 0.2;
  options.clutter = 0.6;
  options.delay = 1;
  options.drop_rate = 0.3;
  return options;
}

}  // namespace testing
}  // namespace ddm
