// Parameters of simulated time. YAML blocks `sim:` and `show:`.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ddm_common/option_checks.h>

#include <string>
#include <vector>

namespace ddm {

/// Block `sim`.
struct SimOptions {
  /// True: simulated time stops until the torque for the image arrives. False: real time.
  bool lockstep = true;
  double watchdog = 5.0;  ///< lock-step: longest wall time between an image and its torque [s]

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("lockstep", lockstep);
    visitor("watchdog", watchdog);
  }

  std::vector<std::string> problems() const {
    OptionChecks sim("sim");
    sim.requireWithin("watchdog", watchdog, 0.1, 86400.0);
    return sim.problems();
  }
};

/// Block `show`: parameters that do not change the results.
struct ShowOptions {
  /// In lock-step: largest number of images per second of wall time; 0: no limit [1/s]
  double frame_rate = 0.0;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor("frame_rate", frame_rate);
  }
  std::vector<std::string> problems() const {
    OptionChecks show("show");
    if (frame_rate != 0.0) show.requireWithin("frame_rate", frame_rate, 1.0, 1e6);
    return show.problems();
  }
};

}  // namespace ddm
